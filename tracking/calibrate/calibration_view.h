#pragma once

#include "core/frame.h"
#include "tracking/calibrate/calibration_options.h"
#include "tracking/calibrate/model_fit.h"
#include "tracking/model/binning.h"
#include "tracking/model/image_model.h"

namespace grainfield::tracking {

/// What a frame is calibrated on: its pixels, or blocks of them.
struct CalibrationView {
    Image counts;
    ModelFit fit;  ///< lengths, levels and visible pixels are of `counts`
};

/// Of a frame and a fit that counts its pixels.
CalibrationView view_by(Binning blocks, const Image& counts, ModelFit fit);

/// Whether blocks tell as much as pixels: a first fit leaves clearly more than noise, and edges are
/// not too wide for the few blocks.
bool blocks_are_enough(const BinningUse& use, const ImageModel& model);

}  // namespace grainfield::tracking
