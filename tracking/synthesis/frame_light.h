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

struct LightNodes {
    double spacing;      ///< [px], about
    bool has_sharpness;  ///< whether the sharpness may differ from place to place
    int border;          ///< [px] that has no say at each side
};

/// Evens out what one FrameLight cannot, where brightness I and radiance M fit by least squares:
///
///   I(x) ≈ o(x) + g(x) M(x) + c(x) ∇²M(x).
///
/// Brightness becomes (I − o − c ∇²M) / g and so does the ceiling. Offset o, gain g and c are
/// bilinear between nodes, so they follow the panel, the layer and the focus, and no sphere. To
/// first order c = (σ² − σ₀²)/2 [px²] for a blur of σ where M has σ₀. Pixels at the ceiling and
/// those that M is far from have no say. A gain is at least half of the mean one.
void even_out(Image& brightness, Image& ceiling, const Image& radiance, const LightNodes& nodes);

/// RMS of an image but for a border [px].
double inner_rms(const Image& image, int border);

}  // namespace grainfield::tracking
