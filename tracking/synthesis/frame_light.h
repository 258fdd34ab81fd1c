#pragma once

#include "core/frame.h"

namespace grainfield::tracking {

/// How radiance becomes brightness in one frame:
///
///   I(x) = offset + M(x) · (gain + fall ρ² ), ρ² the squared distance from the middle in half
///   diagonals.
///
/// Brightness is what a calibrated model makes of counts, about 0 in the core of a sphere and 1 on
/// the panel; gain and fall mend what it got wrong.
struct FrameLight {
    double offset = 0;
    double gain = 1;
    double fall = 0;

    double operator()(double radiance, double squared) const {
        return offset + radiance * (gain + fall * squared);
    }
};

/// Squared distance of a pixel from the middle of a frame in half diagonals, 0 to 1.
double from_middle(const Image& frame, int x, int y);

/// The light under which `radiance` fits `brightness` best, by least squares over pixels below the
/// ceiling. `border` [px] is left out at each side.
FrameLight fit_light(const Image& brightness, const Image& ceiling, const Image& radiance,
                     int border);

/// Brightness − light(radiance); 0 where both reach the ceiling.
Image light_residual(const Image& brightness, const Image& ceiling, const Image& radiance,
                     const FrameLight& light, int threads);

/// RMS of an image but for a border [px].
double inner_rms(const Image& image, int border);

}  // namespace grainfield::tracking
