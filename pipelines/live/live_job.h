#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/option_table.h"
#include "io/video/live_frames.h"
#include "pipelines/job.h"
#include "pipelines/track/track_job.h"

namespace grainfield::pipelines {

/// What tracking a live source is asked for besides TrackJobOptions.
struct LiveJobOptions {
    std::string source;                     ///< as io::LiveOptions::source; empty: none
    std::vector<int> size;                  ///< WIDTH,HEIGHT of raw frames [px]; empty: as they say
    std::int64_t bit_depth = 8;             ///< of raw frames
    std::int64_t queue = 64;                ///< frames that may wait to be tracked
    bool waits = false;                     ///< the source waits instead of frames being dropped
    std::optional<double> longest_silence;  ///< as io::LiveOptions::longest_silence [s]
    std::string preview;  ///< picture renewed each second (PNG, JPEG); empty: none
};

/// Adds the rows to a command's own table.
void describe(LiveJobOptions& options, OptionTable& table);

/// What tracking a live source did.
struct LiveJobResult {
    TrackJobResult track;
    io::LiveCounts counts;
    std::int64_t untracked = 0;  ///< frames that were wanted and not dropped, when a signal came
    int signal = 0;          ///< that ended it: the usual end, not a failure; 0: the source ended
    bool is_silent = false;  ///< the source gave nothing for too long
};

/// Says in the plan what track_live would do; opens no source.
void plan_live(const LiveJobOptions& live, const TrackJobOptions& options, Job& job);

/// Tracks frames while they are filmed, until the source ends or a signal comes, and writes the
/// trajectory frame by frame. What was tracked until then is a complete output, after a failure
/// too; if it cannot be completed, its temporary is left and a warning says so. Frames that come
/// faster than they are tracked are dropped and counted. The calibration is that of the first ten
/// frames, or a kept one. Throws what track_film throws, and OptionError for options that need a
/// film: a part of it, resuming, a background of its own frames.
LiveJobResult track_live(const LiveJobOptions& live, const TrackJobOptions& options, Job& job);

}  // namespace grainfield::pipelines
