#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/results.h"
#include "pipelines/film/film.h"
#include "pipelines/job.h"
#include "report/report.h"
#include "tracking/calibrate/size_choice.h"
#include "tracking/model/image_model.h"
#include "tracking/track_options.h"

namespace grainfield::pipelines {

/// One run a candidate for the page: the part of the frame at `position` that it was tried on, with
/// its discs. The three that explain most, the best first. Empty if the frame cannot be read.
std::vector<Results> candidate_runs(WatchedFrames& frames, std::int64_t position,
                                    const std::vector<tracking::SizeCandidate>& weighed,
                                    const Job& job);

/// The settings that were given with each of them instead, to be copied; but for the one that
/// `taken` is.
std::vector<report::CopyBlock> candidate_blocks(const std::vector<tracking::SizeCandidate>& weighed,
                                                const tracking::TrackOptions& given,
                                                const FilmOptions& film,
                                                const std::optional<tracking::ImageModel>& taken);

/// What to say where a size or polarity that was given explains little, and another one enough.
struct SizeAdvice {
    std::string words;
    tracking::SizeCandidate better;
};

/// Empty where `taken` explains enough, or nothing does.
std::optional<SizeAdvice> advice_on(const tracking::ImageModel& taken,
                                    const std::vector<tracking::SizeCandidate>& weighed);

/// Whether that is the size and polarity of the model.
bool is_of(const tracking::SizeCandidate& candidate, const tracking::ImageModel& model);

/// They with their share of explained variance.
report::Table candidates_table(const std::vector<tracking::SizeCandidate>& weighed);

}  // namespace grainfield::pipelines
