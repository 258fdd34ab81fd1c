#pragma once

#include <cstdint>
#include <vector>

#include "core/results.h"
#include "pipelines/film/film.h"
#include "pipelines/job.h"
#include "report/report.h"
#include "tracking/calibrate/size_choice.h"

namespace grainfield::pipelines {

/// One run a candidate for the page: the part of the frame at `position` that it was tried on, with
/// its discs. The three that explain most, the best first. Empty if the frame cannot be read.
std::vector<Results> candidate_runs(WatchedFrames& frames, std::int64_t position,
                                    const std::vector<tracking::SizeCandidate>& weighed,
                                    const Job& job);

/// The settings that choose each of them, to be copied.
std::vector<report::CopyBlock> candidate_blocks(
    const std::vector<tracking::SizeCandidate>& weighed);

/// They with their share of explained variance.
report::Table candidates_table(const std::vector<tracking::SizeCandidate>& weighed);

}  // namespace grainfield::pipelines
