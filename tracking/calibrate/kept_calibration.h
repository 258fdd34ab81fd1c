#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/frame.h"
#include "tracking/camera/camera.h"
#include "tracking/model/image_model.h"
#include "tracking/model/visible_pixels.h"
#include "tracking/synthesis/bias_correction.h"
#include "tracking/synthesis/film_synthesis.h"

namespace grainfield::tracking {

/// What shows whether a calibration fits a frame.
struct CalibrationCheck {
    double residual = 0;       ///< RMS of image − model after a cold search [contrast]
    double diameter = 0;       ///< D on the exposed edges of what was found [px]; 0: none
    double low = 0, high = 0;  ///< levels: 0.5 % and 99.5 % quantiles [counts]

    bool operator==(const CalibrationCheck&) const = default;
};

/// A calibration that films to come are measured with.
struct KeptCalibration {
    ImageModel model;                   ///< of pixels, or of blocks of them
    int width = 0, height = 0;          ///< of the frames it was made on [px]
    CalibrationCheck check;             ///< of the frame it was made on
    std::optional<Camera> camera = {};  ///< lens and tilt, of whole frames; empty: not corrected
    std::optional<BiasCorrection> bias = {};  ///< of the discs; empty: not corrected
    std::optional<FilmOptics> optics = {};    ///< of synthesis; empty: was not asked for

    /// Throws InputError, with both sizes, for frames of another size.
    void require_size(int other_width, int other_height, const std::string& film) const;
};

/// One cold search with that model.
CalibrationCheck check(const ImageModel& model, const Image& counts, const VisiblePixels& visible,
                       int threads);

/// Why a film no longer fits, in words: the residual is more than half as large again, the diameter
/// differs by more than 2 %, or the contrast by more than 10 %. Empty if it does.
std::vector<std::string> differences(const CalibrationCheck& then, const CalibrationCheck& now);

}  // namespace grainfield::tracking
