#pragma once

#include <cstdint>
#include <optional>

#include "core/frame_source.h"
#include "core/run_plan.h"
#include "tracking/bias_decision.h"
#include "tracking/model/image_model.h"
#include "tracking/synthesis/bias_correction.h"
#include "tracking/track_options.h"

namespace grainfield::tracking {

struct FilmBias {
    std::optional<BiasCorrection> correction;  ///< empty: positions are those of the discs
    BiasDecision decision;
};

/// What positions are corrected with: nothing where correct_bias is false, else the correction of
/// the kept calibration, else where correct_bias asks for it one learned on the first usable frame
/// from `first` on (learn_bias), else the general one (general_correction).
///
/// The general one is used where the true diameter is known, spheres are dark, discs are like those
/// of the cameras that it was learned from and leave more than half of the noise, neither mask nor
/// camera is given, and where it moves the spheres of that frame by no more than 1.5 times their
/// errors (correction_size): its middle is fitted for that. It takes over where one that was asked
/// for is refused, which is warned of, and with synthesis, which begins at corrected discs, from a
/// kept one. Says in `plan` what it does, or why not. A kept one is skipped with a camera or a
/// mask, and without the true diameter, which is warned of. Throws OptionError for bright spheres
/// where one was asked for, and where a kept one was learned for another diameter, cell or camera;
/// Interrupted.
FilmBias bias_of_film(FrameSource& source, const TrackOptions& options, const ImageModel& model,
                      std::int64_t first, int threads, RunPlan& plan);

}  // namespace grainfield::tracking
