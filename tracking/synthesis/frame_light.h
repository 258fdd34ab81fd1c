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

/// A residual beyond this belongs to a wrong arrangement, and has no say in light and optics
/// [contrast].
inline constexpr double kUnexplained = 0.15;

/// Offset and gain of each pixel, as even_out() found them; empty: 0 and 1 all over.
struct UnevenLight {
    Image offset, gain;

    /// Brightness as it was before it was evened out; x and y in the frame that was evened out.
    float uneven(float evened, int x, int y) const {
        return offset.empty() ? evened : offset(x, y) + gain(x, y) * evened;
    }
};

/// Evens out what one FrameLight cannot, where brightness I and radiance M fit by least squares:
///
///   I(x) ≈ o(x) + g(x) M(x).
///
/// Brightness becomes (I − o) / g and so does the ceiling, both then in units of the local gain.
/// Offset o and gain g are bilinear between nodes `spacing` [px] apart, so they follow panel and
/// layer, and no sphere. A side below 1.5 spacings has nodes at its ends only. Pixels at the
/// ceiling, within `border` [px] of the edge and those that M is far from have no say. A gain is at
/// least half of the mean one. Where fewer than 100 pixels for each unknown have a say, or the mean
/// gain is not positive, nothing changes.
UnevenLight even_out(Image& brightness, Image& ceiling, const Image& radiance, double spacing,
                     int border);

/// RMS of an image but for a border [px].
double inner_rms(const Image& image, int border);

/// The part of inner_rms that neighbouring pixels share, √max(0, ⟨v(x) v(x + e)⟩) with e a step to
/// the right or downwards. White noise has none; noise that a camera smooths has some. What a model
/// lacks is shared as far as it is wider than a pixel.
double coherent_rms(const Image& image, int border);

}  // namespace grainfield::tracking
