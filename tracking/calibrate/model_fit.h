#pragma once

#include <vector>

#include "core/frame.h"
#include "core/run_plan.h"
#include "core/vec2.h"
#include "tracking/calibrate/calibration_options.h"
#include "tracking/calibrate/edge_fit.h"
#include "tracking/calibrate/explained_share.h"
#include "tracking/calibrate/first_guess.h"
#include "tracking/locate.h"
#include "tracking/model/binning.h"
#include "tracking/model/image_model.h"
#include "tracking/model/visible_pixels.h"

namespace grainfield::tracking {

/// The disc in pixels of the frame.
DiscProfile disc_in_pixels(const ImageModel& model);

/// Improves a model on an image of dark spheres, step by step.
struct ModelFit {
    CalibrationOptions options;
    DetectionOptions detection;
    RefinementOptions refinement;
    int threads;
    Levels levels;                     ///< of the image it works on
    std::vector<Vec2> positions = {};  ///< of the last update; the next one starts there
    EdgeFit edges = {};
    ExplainedShare explained = {};  ///< by the positions of the last update
    VisiblePixels visible = {};     ///< of the image it works on
    Binning blocks = {};            ///< lengths count them, given ones too

    /// Locates roughly, then refits disc, dark level and background. True once D and w rest.
    bool update(ImageModel& model, const Image& counts);
    /// The same until D and w rest, `rounds` times at most.
    void settle(ImageModel& model, const Image& counts, int rounds);
    static constexpr int kFrameRounds = 2;  ///< of a whole frame

    /// Searches with the chosen model for every sphere, and refits the image on them; the disc that
    /// leaves less of the frame stays. Most spheres are enough where the model leaves little but
    /// noise. Whether it did.
    bool complete(ImageModel& model, const Image& counts, RunPlan& plan);

 private:
    void fit_image(ImageModel& model, const Image& counts);
};

}  // namespace grainfield::tracking
