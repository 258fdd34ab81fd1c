#pragma once

#include <optional>
#include <vector>

#include "core/frame.h"
#include "core/run_plan.h"
#include "tracking/calibrate/model_fit.h"
#include "tracking/calibrate/size_choice.h"
#include "tracking/model/image_model.h"

namespace grainfield::tracking {

/// One first guess, improved on the most dilute part of the frame.
struct SizeTrial {
    Polarity polarity;
    ImageModel model;  ///< of the image in which spheres are dark, with what the part leaves
    ModelFit fit;
    bool is_whole;  ///< the part was all of the frame
    SizeCandidate candidate = {};
};

/// The trial that explains the image beyond doubt, or else the one that explains most of it,
/// charged for its coordinates; none if that is not enough, or two do it about as well. Why goes
/// into `plan`. `fit`: what each trial begins with. All that were tried are left in `weighed`.
std::optional<SizeTrial> best_trial(const Image& counts, const ModelFit& fit, RunPlan& plan,
                                    std::vector<SizeCandidate>& weighed);

}  // namespace grainfield::tracking
