#pragma once

#include "core/frame.h"
#include "tracking/model/background_surface.h"
#include "tracking/model/padded_image.h"
#include "tracking/model/visible_pixels.h"

namespace grainfield::tracking {

/// The light that reaches the camera between the spheres, without knowing where they are: the upper
/// envelope of bright percentiles of tiles. Tiles without any clear pixel (dense crystal) lie below
/// the surface and lose their weight in the iteration. `contrast` [counts] is the scale of what
/// counts as below; uniform if it varies by less than `uniform_tolerance` of it.
BackgroundSurface upper_envelope(const Image& counts, double contrast, double uniform_tolerance,
                                 const VisiblePixels& visible = {});

/// Refines B with the fitted scene: every pixel with transmission T above 0.9 gives B an estimate
/// [I − I_dark (1 − T)]/T of weight T²; tiles of them are fitted by a polynomial. Uniform if the
/// surface varies by less than `uniform_tolerance` of the contrast or explains the tiles no better
/// than chance (F ratio below 3). `previous` comes back when too few pixels are clear.
BackgroundSurface background_between_spheres(const Image& counts, const PaddedImage& transmission,
                                             double dark_level, const BackgroundSurface& previous,
                                             double contrast, double uniform_tolerance);

}  // namespace grainfield::tracking
