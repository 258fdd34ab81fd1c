#pragma once

#include <vector>

#include "core/vec2.h"
#include "tracking/model/padded_image.h"
#include "tracking/refine/joint_fit.h"

namespace grainfield::tracking {

/// Pixels [x0, x1) × [y0, y1).
struct PixelBlock {
    int x0, y0, x1, y1;
};

/// Of all of them, none of which overlaps another one [px].
double area_of(const std::vector<PixelBlock>& blocks);

/// What the model leaves unexplained, by place: Σ (I − M)² over square blocks. One pass over the
/// image.
class ResidualBlocks {
 public:
    ResidualBlocks(const PaddedImage& darkness, const PaddedImage& transmission, int block,
                   int threads = 1);

    /// Over the whole image [contrast² px].
    double total() const { return total_; }

    /// √(total/pixels), 0 without pixels [contrast].
    double rms(double pixels) const;

    /// The misfit about p is known to be less by this much [contrast² px].
    void subtract(Vec2 p, double gain);

    /// Sums over a block and the eight around it, where there are discs [contrast² px]; zero if
    /// there are none.
    struct Usual {
        double median = 0;
        double spread = 0;  ///< robust standard deviation, 1.4826 MAD
    };
    Usual usual(const std::vector<Vec2>& discs) const;

    /// What white noise σ [contrast] leaves in such a sum, no block of it cut by the border.
    double white(double noise) const { return 9.0 * block_ * block_ * noise * noise; }

    /// Runs of blocks in a row of blocks, those with at least `least` on themselves and the eight
    /// around them together: whatever explains that much within one block's length of its centre
    /// has its centre in one of these.
    std::vector<PixelBlock> holding(double least) const;
    /// The middles of these blocks [px].
    std::vector<Vec2> middles(const std::vector<PixelBlock>& runs) const;
    int block() const { return block_; }

 private:
    double around(int column, int row) const;
    int column(Vec2 p) const;
    int row(Vec2 p) const;

    int width_, height_, block_;
    int columns_, rows_;
    double total_ = 0;
    std::vector<double> sums_;  ///< with a margin of one empty block
};

/// Of a fit, in blocks as long as a disc reaches, less `gain`, by how much pending steps lower
/// the misfit about each disc (pending_gain; empty: none is pending).
ResidualBlocks residual_of(const JointFit& fit, const std::vector<double>& gain = {});

/// Σ (I − M)² over the pixels from `low` to `high` [px], as discs are drawn [contrast² px] …
double misfit_in(const JointFit& fit, Vec2 low, Vec2 high);
/// … and over the square of half side `half` [px] about a place.
double misfit_about(const JointFit& fit, Vec2 place, double half);

}  // namespace grainfield::tracking
