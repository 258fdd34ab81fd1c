#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/vec2.h"
#include "tracking/model/disc_profile.h"
#include "tracking/model/kernel_profile.h"

namespace grainfield::tracking {

/// Which pixels of a window a shift redraws. Those away from the edge hardly change in a small
/// step; they stay as they are, still in keeping with the t that is kept.
enum class Redraw { whole, edge };

/// The pixels that a disc can reach whose centre lies within kRoom of a pixel, its anchor, row by
/// row in whole vectors. The same for all discs of a scene, so that a disc's transmission t there
/// can be kept from one step to the next: half of a step's work is then only read.
class DiscStencil {
 public:
    /// For images of that pitch whose rows are `spacing` pixels apart.
    DiscStencil(const DiscProfile& disc, std::ptrdiff_t pitch, int spacing = 1);

    static constexpr double kRoom = 0.75;  ///< per axis [px], [rows]
    static constexpr int kLanes = 8;       ///< rows are whole multiples of this

    struct Row {
        int dy;     ///< from the anchor [rows]
        int first;  ///< first column, from the anchor
        int count;  ///< pixels, a multiple of kLanes
        int at;     ///< where the row begins among the kept values
    };
    const std::vector<Row>& rows() const { return rows_; }
    /// From the first column of any row to the last of any [px]. Rows are whole vectors: narrow
    /// ones may end farther to the right than wide ones.
    int width() const { return last_ - first_ + 1; }
    /// Rows of the pixels within the edge (DiscProfile::edge_reach), with the core: one row for
    /// each line, from the topmost down.
    const std::vector<Row>& edge_spans() const { return edge_spans_; }

    /// kLanes pixels of a row.
    struct Piece {
        std::int32_t offset;  ///< in the images, from the anchor
        std::int32_t at;      ///< among the kept values
        float dx, dy;         ///< of the first pixel, from the anchor
    };
    const std::vector<Piece>& pieces() const { return pieces_; }
    /// Those with pixels that may lie between core and edge_reach(): the gradient is small
    /// everywhere else.
    const std::vector<Piece>& edge_pieces() const { return edge_pieces_; }
    const std::vector<Piece>& redrawn(Redraw redraw) const {
        return redraw == Redraw::whole ? pieces_ : edge_pieces_;
    }
    int spacing() const { return spacing_; }
    std::size_t size() const { return size_; }  ///< values kept per disc
    const DiscProfile& disc() const { return disc_; }
    DiscTerms terms() const { return profile_.terms(); }

 private:
    Piece piece(const Row& row, int x) const;
    void add_edge_row(const Row& row);

    DiscProfile disc_;
    KernelProfile profile_;
    std::ptrdiff_t pitch_;
    int spacing_;
    int first_ = 0, last_ = 0;  ///< columns
    std::vector<Row> rows_;
    std::vector<Row> edge_spans_;
    std::vector<Piece> pieces_;
    std::vector<Piece> edge_pieces_;
    std::size_t size_ = 0;
};

/// The pixel that a disc's window is centred on.
struct Anchor {
    int x = 0;
    int y = 0;  ///< [rows]

    /// Of a centre in pixels, where rows are `spacing` pixels apart.
    static Anchor of(Vec2 centre, int spacing = 1);
    bool operator==(const Anchor&) const = default;
    /// The window there holds a disc at `centre`.
    bool holds(Vec2 centre, int spacing = 1) const;
};

}  // namespace grainfield::tracking
