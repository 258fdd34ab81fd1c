#pragma once

#include "core/frame.h"
#include "tracking/model/visible_pixels.h"

namespace grainfield::tracking {

/// How the four pixels of the cells of 2 × 2 differ, where there is light.
struct ColourMosaic {
    double strength = 0;  ///< |a − b| between the diagonals' mean levels, of the level [-]
    double share = 0;     ///< of the cells that differ in the direction of the majority
    /// A colour filter before the sensor: cells differ by more than 1 %, four of five of them in
    /// one direction, along the diagonals or between both rows and both columns.
    bool is_there = false;
};

/// Looks for the colour filter of a camera (Bayer pattern) in an image that passes for grey: green
/// on one diagonal, red and blue on the other. Cells of 2 × 2 pixels above the middle between the
/// levels count, so that spheres do not; their own gradients cancel in a − b − c + d. O(pixels/4).
ColourMosaic colour_mosaic(const Image& counts, double low, double high,
                           const VisiblePixels& visible = {});

}  // namespace grainfield::tracking
