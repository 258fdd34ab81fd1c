#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/frame.h"
#include "core/run_plan.h"
#include "tracking/calibrate/calibration_options.h"
#include "tracking/calibrate/size_choice.h"
#include "tracking/locate.h"
#include "tracking/model/image_model.h"
#include "tracking/model/visible_pixels.h"

namespace grainfield::tracking {

/// Why a frame cannot hold spheres: no contrast (all black or saturated) or nothing above the
/// noise. Empty if it can. From a sample of its pixels, O(pixels/12).
std::string blank_reason(const Image& counts, const VisiblePixels& visible = {});

struct Calibration {
    ImageModel model;
    /// Rough positions in the frame used, to start from [px of the model, which may be blocks].
    std::vector<Vec2> positions;
    bool is_complete = false;  ///< every sphere was looked for, by its core too
};

/// Estimates the image model from one frame: polarity and rough size from the shape of the
/// thresholded image, background from the upper envelope, D, w and the dark level on the exposed
/// edges of the most dilute patch, then the background on the clear pixels of the whole frame, then
/// how edges meet and whether a learned profile is better (choose_model). Where that leaves a
/// misfit, all spheres are searched for and D and w read once more: a missed sphere widens the
/// discs beside it. Where the frame is to be seen by blocks of pixels (BinningUse) all this, and
/// the model, is of blocks. What was estimated, given or skipped goes into the plan.
///
/// The shape allows several guesses (first_guesses). They are tried on the patch until one explains
/// 95 % of the variance of the darkness, white noise subtracted, with discs that the image
/// resolves; else the one that explains most is taken, charged for its coordinates (choose_size).
/// What was weighed is said in the plan and left in `weighed`. Where a diameter or polarity that
/// was given explains less than 80 %, the automatic guesses are weighed and left there too, and a
/// better one is named in a warning (advice_on_size).
///
/// Empty, with a warning in the plan, when the frame holds nothing to calibrate on: no contrast
/// (all black or saturated), nothing above the noise, or, no diameter given, no discs of one size
/// that explain 80 % of it, or so much noise that it passes for discs. Also when two answers
/// explain it about as well and neither was given. A colour mosaic in the image is warned of
/// (colour_mosaic).
std::optional<Calibration> calibrate(const Image& counts, const CalibrationOptions& options,
                                     const DetectionOptions& detection,
                                     const RefinementOptions& refinement, int threads,
                                     RunPlan& plan, const VisiblePixels& visible = {},
                                     std::vector<SizeCandidate>* weighed = nullptr);

}  // namespace grainfield::tracking
