#pragma once

#include <string>
#include <vector>

#include "core/frame.h"
#include "tracking/calibrate/calibration_options.h"
#include "tracking/calibrate/coarse_size.h"
#include "tracking/model/image_model.h"
#include "tracking/model/visible_pixels.h"

namespace grainfield::tracking {

struct Levels {
    /// 0.5 % and 99.5 % quantiles; those of few spheres are the extremes [counts].
    double low, high;
    double noise;  ///< RMS of what varies from pixel to pixel [counts]
};

/// From every fourth row and third column: a percent of accuracy is plenty; from `sparsely` times
/// fewer of both.
Levels levels_of(const Image& counts, const VisiblePixels& visible = {}, int sparsely = 1);

/// Why a frame cannot hold spheres (calibration.h). Empty if it can.
std::string blank_reason(const Levels& levels);

/// −I: bright spheres become dark ones.
Image turned_round(const Image& counts);

/// Where calibration may begin.
struct FirstGuess {
    Polarity polarity = Polarity::dark;
    BackgroundSurface background;  ///< of the image in which spheres are dark [counts]
    double dark_level = 0;         ///< likewise
    CoarseSize size;               ///< radius 0 if the mask holds no disc
};

/// From the shape of the image thresholded halfway between background and core: for each polarity
/// allowed the sizes of coarse_sizes(), at least one guess; first those of the polarity whose
/// likeliest discs cover more of their mask.
std::vector<FirstGuess> first_guesses(const Image& counts, const Levels& levels,
                                      PolarityChoice polarity, double uniform_tolerance,
                                      const VisiblePixels& visible = {});

}  // namespace grainfield::tracking
