#pragma once

#include <cstdint>
#include <optional>

#include "core/frame_source.h"
#include "core/run_plan.h"
#include "tracking/model/image_model.h"
#include "tracking/synthesis/bias_correction.h"
#include "tracking/track_options.h"

namespace grainfield::tracking {

/// The correction of the kept calibration, or where one is asked for that of the first usable frame
/// from `first` on (learn_bias). Empty where none is wanted or it is refused, with a warning. Says
/// in `plan` what it does: a kept one is skipped with synthesis, a camera or a mask. Throws
/// OptionError for bright spheres, and where a kept one was learned for another diameter, cell or
/// camera.
std::optional<BiasCorrection> bias_of_film(FrameSource& source, const TrackOptions& options,
                                           const ImageModel& model, std::int64_t first, int threads,
                                           RunPlan& plan);

}  // namespace grainfield::tracking
