#pragma once

#include <cstddef>
#include <vector>

#include "core/frame.h"
#include "core/vec2.h"
#include "tracking/model/disc_profile.h"

namespace grainfield::tracking {

/// A frame seen by blocks of factor × factor pixels, each the mean of its pixels. The centre of
/// block (column, row) is the point (column, row) of the binned frame. What is left at the right
/// and lower border, less than a block wide, is not seen.
struct Binning {
    int factor = 1;  ///< pixels a side; 1: frames as they are

    bool is_none() const { return factor == 1; }
    int blocks(int pixels) const { return pixels / factor; }
    /// From blocks to pixels and back.
    Vec2 in_frame(Vec2 p) const {
        return {p.x * factor + first_centre(), p.y * factor + first_centre()};
    }
    Vec2 in_blocks(Vec2 p) const {
        return {(p.x - first_centre()) / factor, (p.y - first_centre()) / factor};
    }
    /// A disc of the frame, in blocks, and back. The derivative of a tanh edge, sech², has variance
    /// π²w²/12; the mean over a block adds factor²/12. Other edges are widened likewise. An edge
    /// too sharp to be told from a block is 0.05 px wide in the frame.
    DiscProfile in_blocks(const DiscProfile& disc) const;
    DiscProfile in_frame(const DiscProfile& disc) const;
    /// An edge width of the frame, in blocks.
    double edge_in_blocks(double width) const;
    /// One row of blocks, of the `factor` rows of pixels from `top` on, `stride` apart. `sums`:
    /// memory for one row of pixels, as long as that.
    void bin_row(const float* top, std::ptrdiff_t stride, std::vector<float>& sums, float* row,
                 int columns) const;
    Image binned(const Image& frame) const;
    /// The same, into an image whose memory is kept.
    void bin(const Image& frame, Image& binned) const;

    bool operator==(const Binning&) const = default;

 private:
    double first_centre() const { return 0.5 * (factor - 1); }
};

}  // namespace grainfield::tracking
