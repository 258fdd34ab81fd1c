#pragma once

#include <vector>

#include "core/vec2.h"
#include "tracking/model/disc_profile.h"
#include "tracking/model/padded_image.h"

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
};

/// T ← T · t_centre, disc by disc.
void place_discs(PaddedImage& transmission, const std::vector<Vec2>& centres,
                 const DiscProfile& disc);
void place_disc(PaddedImage& transmission, Vec2 centre, const DiscProfile& disc);

/// By how much Σ (I − M)² would grow if the disc were lifted: what it explains [contrast² px].
double explained_misfit(const PaddedImage& darkness, const PaddedImage& transmission, Vec2 centre,
                        const DiscProfile& disc);

}  // namespace grainfield::tracking
