#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "core/frame.h"
#include "core/support/huge_pages.h"
#include "core/vec2.h"
#include "tracking/model/disc_profile.h"
#include "tracking/model/padded_image.h"
#include "tracking/model/visible_pixels.h"
#include "tracking/refine/computed_disc.h"
#include "tracking/refine/disc_templates.h"
#include "tracking/refine/drawing_order.h"
#include "tracking/refine/drawn_disc.h"

namespace grainfield::tracking {

/// Where a disc is drawn: where it is, or at the template nearest to that (disc_templates.h).
enum class Drawing { exactly, roughly };

/// A disc as it is drawn.
struct SceneDisc {
    Anchor anchor;
    Vec2 centre;             ///< [px]
    std::uint32_t slot = 0;  ///< of its transmissions, if they are computed
    /// Of its template; DiscTemplates::kNone: its transmissions are computed.
    std::uint16_t number = DiscTemplates::kNone;
    float stale = 0;  ///< [px] path since it was drawn as a whole
};

/// The darkness image of one frame, and the transmission T = Π_j t_j of the discs drawn on it.
///
/// Discs are numbered in order of their addition. Each is drawn on a window of its own: t is kept
/// there, computed or from a template, so that it can be divided out again. Memory is 2 bytes per
/// pixel of each window (1.4 kB at D = 16 px) besides the two images. Functions that draw may run
/// in parallel for discs whose windows do not touch.
class DiscScene {
 public:
    /// Writes row y of an image.
    using WriteRow = std::function<void(int y, float* row)>;

    /// The rows of the image may be `spacing` pixels apart.
    DiscScene(const Image& darkness, const DiscProfile& disc, int spacing);

    /// Begins anew, without discs, on an image of the same size; rows are written in parallel.
    void restart(const WriteRow& write_row, int threads);
    /// Goes on with the same discs on another image of that size.
    void look_at(const Image& darkness, int threads);
    /// From the next restart on.
    void set_visible(VisiblePixels visible);

    const PaddedImage& darkness() const { return darkness_; }
    const PaddedImage& transmission() const { return transmission_; }
    const DiscProfile& disc() const { return stencil_.disc(); }
    int spacing() const { return stencil_.spacing(); }
    int width() const { return darkness_.width(); }
    int height() const { return darkness_.height() * spacing(); }
    double pixels() const { return pixels_; }  ///< that are visible
    std::size_t size() const { return discs_.size(); }
    const SceneDisc& operator[](std::size_t j) const { return discs_[j]; }

    /// The place within the image where a disc at p is put.
    Vec2 inside(Vec2 p) const;
    bool has_templates() const { return !templates_.is_empty(); }
    int templates_per_pixel() const { return templates_.per_pixel(); }
    /// Only with templates.
    DiscTemplates::Place nearest(Vec2 p) const { return templates_.nearest(p); }
    /// Where a disc that is to be at p is drawn roughly.
    Vec2 drawn_place(Vec2 p) const {
        return has_templates() ? nearest(inside(p)).centre : inside(p);
    }
    /// A disc is drawn from the template of that place.
    bool is_at(std::size_t j, const DiscTemplates::Place& place) const;
    DiscTemplates::Place place_of(std::size_t j) const;
    /// A disc is drawn where a drawing of that kind at p would put it.
    bool is_drawn_at(std::size_t j, Vec2 p, Drawing drawing) const;

    /// Adds a disc that is not drawn yet.
    void append(Vec2 centre);
    /// Draws a disc that is not drawn yet; where it is drawn.
    Vec2 draw(std::size_t j, Drawing drawing);
    void remove(const std::vector<char>& keep);
    /// Draws a disc anew at p.
    void redraw(std::size_t j, Vec2 p, Drawing drawing);

    /// How a move is undone.
    struct WayBack {
        BeforeShift pixels;
        SceneDisc disc;
        bool in_window = false;
    };
    /// Divides a disc out and multiplies it in at `to`. Returns the change of Σ (I − M)².
    double move(std::size_t j, Vec2 to, WayBack& back);
    /// Undoes the last move of a disc.
    void move_back(std::size_t j, const WayBack& back);
    /// The same in a window of its own.
    double move_to(std::size_t j, Vec2 to);
    double move_to(std::size_t j, const DiscTemplates::Place& place);

    /// Asks for the pixels of a disc ahead of their use.
    void fetch(std::size_t j) const { tracking::fetch(view(discs_[j])); }
    NormalEquations normal_equations(std::size_t j) const {
        return linearise(view(discs_[j]), discs_[j].centre);
    }
    CrossBlock coupling(std::size_t i, std::size_t j) const;
    double explained(std::size_t j) const { return tracking::explained(view(discs_[j])); }
    LocalMisfit misfit_about(std::size_t j) const {
        return local_misfit(view(discs_[j]), discs_[j].centre);
    }
    /// Σ (I − M)² over the image, row by row; the same bits for any number of threads.
    double misfit(int threads) const;

    /// Parts of the frame in the order of drawing (drawing_order.h).
    DrawingOrder drawing_order() const;
    int parts() const { return DrawingOrder::parts(darkness_, stencil_); }

 private:
    ConstStencilView view(const SceneDisc& disc) const;
    StencilView view(const SceneDisc& disc);
    DiscTemplate shape_of(const SceneDisc& disc) const;
    std::uint32_t free_slot();
    void use(SceneDisc& disc, const DiscTemplates::Place& place);
    std::pair<Redraw, float> redraw_for(const SceneDisc& disc, Vec2 to) const;

    PaddedImage darkness_;
    PaddedImage transmission_;
    DiscStencil stencil_;
    DiscTemplates templates_;
    std::vector<SceneDisc> discs_;
    HugeVector<HalfFloat> kept_;       ///< transmissions, stencil_.size() a slot
    std::vector<std::uint32_t> free_;  ///< slots given back
    std::uint32_t slots_ = 0;          ///< in use or given back
    VisiblePixels visible_;
    double pixels_;
};

}  // namespace grainfield::tracking
