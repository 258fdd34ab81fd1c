#pragma once

#include <cstdint>
#include <optional>

#include "core/frame_source.h"
#include "core/run_plan.h"
#include "tracking/model/image_model.h"
#include "tracking/synthesis/bias_correction.h"
#include "tracking/track_options.h"

namespace grainfield::tracking {

/// What positions are corrected with: nothing where correct_bias is false, else the correction of
/// the kept calibration, else one learned on the first usable frame from `first` on (learn_bias).
///
/// One is learned where correct_bias asks for it. By itself (LearnBias::by_itself) it is learned in
/// films of 500 frames or more, where the true diameter is known, spheres are dark, discs leave
/// more than half of the noise, and neither mask, camera, synthesis nor a kept calibration is
/// given. Says in `plan` what it does, or why not; warns where one that was asked for is refused.
/// A kept one is skipped with synthesis, a camera or a mask. Throws OptionError for bright spheres
/// where it was asked for, and where a kept one was learned for another diameter, cell or camera;
/// Interrupted.
std::optional<BiasCorrection> bias_of_film(FrameSource& source, const TrackOptions& options,
                                           const ImageModel& model, std::int64_t first, int threads,
                                           RunPlan& plan);

}  // namespace grainfield::tracking
