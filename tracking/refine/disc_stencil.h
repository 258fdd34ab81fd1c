#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/vec2.h"
#include "tracking/model/disc_profile.h"
#include "tracking/model/padded_image.h"

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
    /// Rows of the pixels within kEdgeInWidths w of the edge, with the core: one row for each line,
    /// from the topmost down.
    const std::vector<Row>& edge_spans() const { return edge_spans_; }

    /// kLanes pixels of a row.
    struct Piece {
        std::int32_t offset;  ///< in the images, from the anchor
        std::int32_t at;      ///< among the kept values
        float dx, dy;         ///< of the first pixel, from the anchor
    };
    const std::vector<Piece>& pieces() const { return pieces_; }
    /// Those with pixels that may lie within kEdgeInWidths w of the edge: the gradient is small
    /// everywhere else.
    const std::vector<Piece>& edge_pieces() const { return edge_pieces_; }
    const std::vector<Piece>& redrawn(Redraw redraw) const {
        return redraw == Redraw::whole ? pieces_ : edge_pieces_;
    }
    int spacing() const { return spacing_; }
    std::size_t size() const { return size_; }  ///< values kept per disc
    const DiscProfile& disc() const { return disc_; }

 private:
    Piece piece(const Row& row, int x) const;
    void add_edge_row(const Row& row);

    DiscProfile disc_;
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

/// Transmissions of one disc on its stencil, in half precision: t ∈ [1e-3, 1] to 2.4e-4 of its
/// value. What is stored is what multiplies the image, so that it divides out again.
using HalfFloat = std::uint16_t;

/// t of a disc somewhere in its window and −∂t/∂(x, y)/t, stencil.size() values each, in the order
/// of the stencil, and the pieces in which t differs from 1.
struct DiscTemplate {
    const HalfFloat* t = nullptr;
    const HalfFloat* x = nullptr;
    const HalfFloat* y = nullptr;
    const std::vector<DiscStencil::Piece>* pieces = nullptr;
};

/// Fills the tables of a template; centre seen from the anchor [px].
void tabulate(const DiscStencil& stencil, Vec2 centre, HalfFloat* t, HalfFloat* x, HalfFloat* y);

/// A disc's window in the images of a scene. The images need the margin of disc_kernel.h and the
/// pitch of the stencil.
struct StencilView {
    const DiscStencil& stencil;
    const PaddedImage& darkness;
    PaddedImage& transmission;
    Anchor anchor;
    HalfFloat* own;        ///< stencil.size() values, where t is kept when it is computed
    DiscTemplate shape{};  ///< what the disc is drawn from, if it is; then `own` is not read

    bool has_shape() const { return shape.t != nullptr; }
    const HalfFloat* kept() const { return has_shape() ? shape.t : own; }
};

/// Asks for a disc's pixels ahead of their use.
void fetch(const StencilView& view);

/// T ← T · t_centre, t kept. Returns the change of Σ (I − M)².
double place(const StencilView& view, Vec2 centre);

/// The same without the answer.
void draw(const StencilView& view, Vec2 centre);

/// T ← T · t, from the view's template.
void draw_template(const StencilView& view);
/// The same; returns the change of Σ (I − M)².
double place_template(const StencilView& view);

/// T ← T / t. Returns the change of Σ (I − M)².
double lift(const StencilView& view);

/// By how much Σ (I − M)² would grow if the disc were lifted [contrast² px].
double explained(const StencilView& view);

/// The normal equations of one disc's position, all others fixed:
///   J = ∂M/∂(x, y) = T · (2/w) P · (x − centre)/r,  A = Σ J Jᵀ,  b = Σ J (I − M).
struct NormalEquations {
    double xx = 0, xy = 0, yy = 0;  ///< A [1/px²]
    double bx = 0, by = 0;          ///< b [1/px]
    double misfit = 0;              ///< Σ (I − M)² over the edge
};

/// Summed over the edge. `centre` is where t was kept.
NormalEquations linearise(const StencilView& view, Vec2 centre);

/// Σ (I − M)² over the visible pixels within reach, and their number.
struct LocalMisfit {
    double sum = 0;  ///< [contrast²]
    double pixels = 0;
};
LocalMisfit local_misfit(const StencilView& view, Vec2 centre);

/// Σ J_a J_bᵀ over the pixels that both edges reach: what couples the positions of two discs.
struct CrossBlock {
    double xx = 0, xy = 0, yx = 0, yy = 0;  ///< [1/px²]
};
/// Each centre is where the t of that disc was kept.
CrossBlock coupling(const StencilView& a, Vec2 centre_a, const StencilView& b, Vec2 centre_b);

/// T and t before a shift.
struct BeforeShift {
    Redraw redraw = Redraw::whole;
    std::vector<float> transmission;
    std::vector<HalfFloat> kept;
};

/// T ← T · t_to / t, t kept anew, in the disc's own values; the anchor must hold `to`, and a disc
/// drawn from a template is redrawn as a whole. Returns the change of Σ (I − M)².
double shift(const StencilView& view, Vec2 to, Redraw redraw, BeforeShift& before);

/// The same without the answer and the way back.
void redraw(const StencilView& view, Vec2 to, Redraw redraw);

/// T ← T · t_to / t with both from tables; the view stays that of before. Returns the change of Σ
/// (I − M)². The way back is the same with the templates exchanged.
double shift(const StencilView& view, const DiscTemplate& to);

/// Undoes the last shift.
void undo(const StencilView& view, const BeforeShift& before);

}  // namespace grainfield::tracking
