#pragma once

#include <vector>

#include "core/vec2.h"
#include "tracking/disc_profile.h"
#include "tracking/padded_image.h"

namespace grainfield::tracking {

/// Small pure kernels of the product-of-transmissions model on the pixels around one disc.
///
///   M(x) = 1 − T(x),   T(x) = Π_j t_j(x),   t_j = 1 − P_j
///
/// Single precision, explicit vectors chosen for the processor at run time (Highway). t is kept
/// within [1e-3, 1], so that a disc can be divided out of T again. The margin of the images must
/// be at least scene_margin(), with darkness 1 and transmission 0 in it: such pixels have neither
/// residual nor gradient and never change.
int scene_margin(const DiscProfile& disc);

/// A disc never moves further than this in one step [px].
double longest_step(const DiscProfile& disc);

PaddedImage padded_darkness(const Image& darkness, const DiscProfile& disc);
PaddedImage clear_transmission(int width, int height, const DiscProfile& disc);

/// The pixels around one disc, row by row. Reused from disc to disc to save allocations.
class DiscWindow {
 public:
    /// Pixels within `half` of the centre; none if all of them lie outside the image.
    void enclose(const PaddedImage& image, Vec2 centre, double half);

    int first_row = 0;
    int rows = 0;
    std::vector<int> first;  ///< first column of each row
    std::vector<int> count;  ///< pixels of each row
    int stride = 0;          ///< floats that a gradient keeps per row
};

/// T ← T · t_centre.
void place_disc(PaddedImage& transmission, Vec2 centre, const DiscProfile& disc);

/// By how much Σ (I − M)² would grow if the disc were lifted: what it explains [contrast² px].
double explained_misfit(const PaddedImage& darkness, const PaddedImage& transmission, Vec2 centre,
                        const DiscProfile& disc);

/// RMS of I − M on the pixels of the image within reach of a disc; NaN if there are none.
double local_residual(const PaddedImage& darkness, const PaddedImage& transmission, Vec2 centre,
                      const DiscProfile& disc);

/// J of a disc on its window: two floats a pixel in planes, `window.stride` floats a row.
struct DiscGradient {
    std::vector<float> x, y;
};
void gradient(const PaddedImage& transmission, Vec2 centre, const DiscProfile& disc,
              DiscWindow& window, DiscGradient& out);

/// Σ J_a J_bᵀ over the pixels that two windows share: what couples the positions of two discs.
struct CrossBlock {
    double xx = 0, xy = 0, yx = 0, yy = 0;  ///< [1/px²]
};
CrossBlock cross_block(const DiscWindow& a, const DiscGradient& gradient_a, const DiscWindow& b,
                       const DiscGradient& gradient_b);

}  // namespace grainfield::tracking
