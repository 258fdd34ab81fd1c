#pragma once

#include "core/frame.h"
#include "pipelines/film/film.h"
#include "pipelines/job.h"
#include "report/page/alternatives.h"
#include "tracking/model/image_model.h"
#include "tracking/tracker.h"

namespace grainfield::pipelines {

/// Tracks a part of the frame with other diameters, the other polarity and other thresholds
/// (`detect.evidence`), each calibrated and searched afresh: what the sliders of the page show.
/// They are about `own_polarity` and the apparent diameter `own` [px]. The part is about 24 of it
/// wide, at the centre of the frame. `evidence`: the threshold in use. The settings of each are
/// those given, of tracker and film, with its three in their places. Takes a few seconds. Throws
/// Interrupted.
report::Alternatives tuned_alternatives(const Frame& frame, tracking::Polarity own_polarity,
                                        double own, double evidence,
                                        const tracking::TrackOptions& options,
                                        const FilmOptions& film, const Job& job);

}  // namespace grainfield::pipelines
