#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "tracking/model/padded_image.h"
#include "tracking/refine/disc_stencil.h"

namespace grainfield::tracking {

/// The order in which all discs of a frame are drawn and read. Each reads its pixels while they are
/// in the cache, and no two threads write the same pixel.
///
/// The frame is divided into cells as large as a window: windows of two cells with a third between
/// them share no pixel. Strips of columns go down in parallel, row by row; the last column of each
/// but the last, the seam, goes down after them. A part is what one strip or seam holds of a row.
/// The order is the same for any number of threads.
class DrawingOrder {
 public:
    /// Of discs with these anchors, in images of that size.
    DrawingOrder(const PaddedImage& image, const DiscStencil& stencil,
                 const std::vector<Anchor>& anchors);
    static int parts(const PaddedImage& image, const DiscStencil& stencil);

    using Draw = std::function<void(std::uint32_t disc)>;
    using Visit = std::function<void(int part, const std::vector<std::uint32_t>& discs)>;

    /// Draws all discs; each part is visited as soon as all discs that share pixels with its own
    /// are drawn. Pixels of `drawn` and `seen` are asked for ahead of the drawing and of the visit.
    void draw_and_visit(int threads, const PaddedImage& drawn, const PaddedImage& seen,
                        const Draw& draw, const Visit& visit) const;
    /// The same visits alone.
    void visit(int threads, const Visit& visit) const;

 private:
    DrawingOrder(const PaddedImage& image, const DiscStencil& stencil);
    std::size_t strip(int s, int row) const {
        return static_cast<std::size_t>(s) * static_cast<std::size_t>(rows_) +
               static_cast<std::size_t>(row);
    }
    std::size_t seam(int s, int row) const { return strip(strips_ + s, row); }
    /// Columns [first, end) of cells are those of strip s.
    int first_column(int s) const { return (s * columns_ + strips_ - 1) / strips_; }
    void go_down(int s, bool is_seam, const PaddedImage& drawn, const PaddedImage& seen,
                 const Draw& draw, const Visit& visit) const;

    int cell_width_, cell_height_;
    int rows_, columns_, strips_;
    std::vector<std::vector<std::uint32_t>> drawn_;    ///< of each row of each strip, then seam
    std::vector<std::vector<std::uint32_t>> visited_;  ///< likewise; a seam's with both neighbours
};

}  // namespace grainfield::tracking
