#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/support/checkpoint.h"
#include "io/h5/snapshot_log.h"
#include "pipelines/session.h"

namespace grainfield::pipelines {

/// What lets a tracking run be taken up again: OUTPUT.checkpoint, the state after some frame, and
/// OUTPUT.snapshots, what was written up to there. Both go when the run is done; a run that fails
/// before its first checkpoint leaves neither.
class TrackCheckpoint {
 public:
    struct Options {
        bool resume = false;
        double every = 1;  ///< time between checkpoints [min]
    };

    /// Reads the checkpoint if one is to be resumed and is there. `pictures`: files besides the
    /// inputs, compared by their content. Call it before the output is claimed. Throws OutputError
    /// if there is one and neither --resume nor --force was given, InputError if it is of a run
    /// with other inputs, pictures or options.
    TrackCheckpoint(const Session& session, const std::vector<std::string>& pictures,
                    const std::string& output, const Options& options);
    ~TrackCheckpoint();
    TrackCheckpoint(const TrackCheckpoint&) = delete;
    TrackCheckpoint& operator=(const TrackCheckpoint&) = delete;

    /// To go on from; null: from the beginning.
    const Checkpoint* from() const { return from_ ? &*from_ : nullptr; }
    /// Positions of the frames that were kept to look at.
    std::vector<std::int64_t> previews() const;
    /// Wall time that was spent before [s].
    double seconds_before() const;

    /// The snapshots so far, cut off where the checkpoint was; without one empty. Call it once,
    /// after the output was claimed.
    io::SnapshotLog* open_log();

    bool is_due() const;
    void save(Checkpoint&& state, const std::vector<std::int64_t>& previews,
              const Session& session);
    /// "; go on with --resume" if that is possible.
    std::string advice() const;
    /// The run is done.
    void remove();
    /// The process ends at once: leaves nothing that is of no use. Safe from any thread.
    void abandon() const;

 private:
    std::filesystem::path with_suffix(const char* suffix) const;
    std::filesystem::path path() const { return with_suffix(".checkpoint"); }

    std::filesystem::path output_;
    Options options_;
    std::vector<std::pair<std::string, std::string>> configuration_;
    std::optional<Checkpoint> from_;
    std::optional<io::SnapshotLog> log_;
    bool is_there_ = false;
    std::chrono::steady_clock::time_point saved_ = std::chrono::steady_clock::now();
};

}  // namespace grainfield::pipelines
