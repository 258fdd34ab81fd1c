#pragma once

#include <vector>

#include "core/frame.h"
#include "core/run_plan.h"
#include "core/vec2.h"
#include "tracking/calibrate/calibration_options.h"
#include "tracking/locate.h"
#include "tracking/model/image_model.h"
#include "tracking/model/visible_pixels.h"

namespace grainfield::tracking {

/// Chooses how edges meet (OverlapRule) and whether the profile is tanh or a learned one
/// (learn_profile), where the options leave it open: by fits of the frame, the spheres brought to
/// rest, of which one must leave 1 % less residual than the simpler one. A learned profile has
/// to leave 15 % less, in the pixels that it is learned from and, fitted, where spheres overlap.
/// The profile is learned from the residual of the meeting chosen, with tanh edges. Too few pixels
/// to learn from leave tanh; said in the plan, and warned of if the learned profile was asked for.
/// `model` is in terms of dark spheres; `positions`: where they are, roughly. One to three fits.
void choose_model(const Image& counts, const std::vector<Vec2>& positions,
                  const CalibrationOptions& options, const DetectionOptions& detection,
                  const RefinementOptions& refinement, int threads, const VisiblePixels& visible,
                  ImageModel& model, RunPlan& plan);

}  // namespace grainfield::tracking
