#pragma once

#include "tracking/model/padded_image.h"

namespace grainfield::tracking {

/// What a model leaves of the image, from evenly spaced rows, as many as a percent of accuracy
/// needs.
struct Remainder {
    /// RMS of the camera's noise, as flat pixels have it; of neighbouring ones where those do not
    /// show it [contrast].
    double noise = 0;
    /// Mean square where there are spheres, without what is left of missing ones [contrast²].
    double misfit = 0;
};

/// Of darkness − (1 − transmission). Pixels of transmission 0 are not seen.
Remainder remainder(const PaddedImage& darkness, const PaddedImage& transmission);

}  // namespace grainfield::tracking
