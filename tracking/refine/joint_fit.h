#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "core/frame.h"
#include "core/option_table.h"
#include "core/support/huge_pages.h"
#include "core/vec2.h"
#include "tracking/model/disc_profile.h"
#include "tracking/model/padded_image.h"
#include "tracking/model/visible_pixels.h"
#include "tracking/refine/computed_disc.h"
#include "tracking/refine/disc_stencil.h"
#include "tracking/refine/disc_templates.h"
#include "tracking/refine/drawing_order.h"
#include "tracking/refine/drawn_disc.h"

namespace grainfield::tracking {

struct RefinementOptions {
    double tolerance = 0.003;  ///< [px] a disc rests when its step is smaller
    int max_sweeps = 150;      ///< most sweeps over the discs in one refinement
};

OptionTable describe(RefinementOptions& options);

/// Where a disc is drawn: where it is, or at the template nearest to that (disc_templates.h).
enum class Drawing { exactly, roughly };

/// All discs of one frame and the image that they make together.
///
/// Least squares on the product of transmissions, M = 1 − Π_j (1 − P_j), over all positions at
/// once: Gauss–Seidel sweeps of damped 2×2 Gauss–Newton steps, each disc against the present image
/// of all others. A step that raises the local misfit is shortened. A disc rests when its next
/// step, judged from how the last two shrank, would be below the tolerance; discs whose
/// neighbourhood rests are skipped, and a step below the tolerance moves the position without
/// redrawing the disc. Fixed points are those of the joint problem.
///
/// Tiles of four colours are swept colour by colour, each several times while it is in the cache,
/// discs of a tile in order of index: the result does not depend on the number of threads. Cost
/// about 1 µs per disc and sweep at D = 16 px; memory 2 bytes per pixel of each disc's window (1.4
/// kB at D = 16 px) besides the two images.
class JointFit {
 public:
    /// Writes row y of an image.
    using WriteRow = std::function<void(int y, float* row)>;

    /// The rows of the image may be `spacing` pixels apart: enough for the first steps of a fit at
    /// a fraction of their cost.
    JointFit(const Image& darkness, const DiscProfile& disc, int threads, int spacing = 1);

    int spacing() const { return stencil_.spacing(); }
    /// Begins anew, without discs, on an image of the same size; memory is kept.
    void restart(const Image& darkness);
    /// On the image whose rows `write_row` writes, rows in parallel.
    void restart(const WriteRow& write_row);

    /// From the next restart on.
    void set_visible(VisiblePixels visible);
    /// Pixels that are looked at.
    double pixels() const { return pixels_; }

    /// Where a disc is put that is to be at p: within the image …
    Vec2 inside(Vec2 p) const;
    /// … and, if many are put there at once, at the nearest place that there is a template for
    /// (disc_templates.h).
    Vec2 roughly(Vec2 p) const;
    void add(Vec2 position);
    /// Many at once, in parallel, each roughly where it is to be. `explained`: what each disc is
    /// known to explain, until something near it moves; empty: unknown. `left`: how far they are
    /// expected to be from where they belong [px]; those nearer than the tolerance take no step.
    void add_all(const std::vector<Vec2>& positions, const std::vector<double>& explained = {},
                 std::optional<double> left = {});

    /// What is done with the discs of one of parts() parts of the frame.
    using Visit = DrawingOrder::Visit;
    int parts() const;
    /// add_all() on an empty fit; each part is visited as soon as all discs that share pixels with
    /// its own are drawn, while these pixels are in the cache: what has to be known of all discs
    /// costs a third of a look at each from memory. Parts are visited in parallel.
    void add_all(const std::vector<Vec2>& positions, const std::vector<double>& explained,
                 std::optional<double> left, const Visit& visit);
    /// The same visits to discs that are drawn.
    void in_parts(const Visit& visit) const;
    /// Goes up with everything that is drawn.
    std::uint64_t revision() const { return revision_; }
    void move(std::size_t j, Vec2 to);
    /// Removes the discs whose entry in `keep` is zero.
    void keep_only(const std::vector<char>& keep);

    struct Summary {
        int sweeps = 0;
        std::int64_t steps = 0;      ///< disc updates done
        std::int64_t skipped = 0;    ///< disc updates left out because the neighbourhood rested
        std::int64_t unsettled = 0;  ///< discs still moving when max_sweeps ended it
    };
    /// Roughly: discs are drawn at the nearest template, and come to rest up to that much from
    /// where they would; a joint step mends it.
    Summary refine(const RefinementOptions& options, Drawing drawing = Drawing::exactly);

    const std::vector<Vec2>& positions() const { return positions_; }
    /// How far a disc would move in its next step, judged from the last two [px].
    double step_left(std::size_t j) const { return static_cast<double>(discs_[j].left); }
    /// That step is longer than the tolerance [px].
    bool is_restless(std::size_t j, double tolerance) const {
        return discs_[j].is_restless(tolerance);
    }
    const PaddedImage& darkness() const { return darkness_; }
    const PaddedImage& transmission() const { return transmission_; }
    const DiscProfile& disc() const { return profile_; }
    int threads() const { return threads_; }
    /// Results do not depend on it.
    void set_threads(int threads) { threads_ = threads; }

    /// Σ (I − M)² that each disc explains (disc_stencil.h, explained). Discs in whose neighbourhood
    /// nothing has moved by more than 0.2 px since the last call keep their value.
    const std::vector<double>& explained();

    /// As drawn now.
    NormalEquations normal_equations(std::size_t j) const;
    CrossBlock coupling(std::size_t i, std::size_t j) const;
    /// Asks for the pixels of a disc ahead of their use.
    void fetch(std::size_t j) const;

    /// A displacement of all discs at once, from where they are drawn.
    struct Displacement {
        std::vector<Vec2> step;   ///< [px]
        std::vector<float> left;  ///< known to be left of it [px]
    };
    static constexpr double kLongestStep = 0.25;  ///< [px]
    /// Moves every disc, by kLongestStep at most: who would go farther steps again in the next
    /// refine(), and with `check_far` who goes by more than `far`. Steps shorter than `least_drawn`
    /// [px] are not drawn. How many went by more than `far` [px].
    std::int64_t displace(const Displacement& all, double least_drawn, double far,
                          bool check_far = false);
    /// Discs near those that have gone, since this was asked last, where no Displacement or a far
    /// one led them: who shares edge pixels with one of these, and they themselves.
    std::vector<char> take_disturbed();

    /// Where it is less where it is drawn [px].
    Vec2 undrawn_step(std::size_t j) const { return positions_[j] - discs_[j].placed; }
    /// Draws all discs where they are …
    void draw_undrawn();
    /// … nearer than `range` to one of these places [px].
    void draw_undrawn_near(const std::vector<Vec2>& places, double range,
                           Drawing drawing = Drawing::exactly);

    /// RMS of I − M within reach of each disc [contrast]; NaN without pixels. `gain`: by how much
    /// what is not drawn lowers the misfit about each disc [contrast²].
    std::vector<double> residuals(const std::vector<double>& gain = {}) const;

    /// RMS of I − M over the visible pixels of the frame, likewise [contrast].
    double residual_rms(const std::vector<double>& gain = {}) const;

 private:
    /// One disc: where it is and what is known of it.
    struct Disc {
        Anchor anchor;
        Vec2 placed;             ///< where it is in the image of all discs [px]
        std::uint32_t slot = 0;  ///< of its transmissions, if they are computed
        /// Of the template that it is drawn from; DiscTemplates::kNone: they are computed.
        std::uint16_t number = DiscTemplates::kNone;
        float last_step = 0;        ///< [px]; large for discs that have not moved yet
        float left = 0;             ///< [px] expected of the next step; large likewise
        float stale = 0;            ///< [px] path since it was drawn as a whole
        float drift = 0;            ///< [px] path since `explained`; large for new discs
        bool is_disturbed = false;  ///< went elsewhere than a Displacement led it
        double explained = 0;       ///< as of the last call of explained()

        /// In the precision of `left`: who is said to be a tolerance away rests.
        bool is_restless(double tolerance) const { return left > static_cast<float>(tolerance); }
    };

    /// What is seen through a const fit is only read.
    StencilView view(const Disc& disc) const;
    int height() const { return darkness_.height() * stencil_.spacing(); }
    std::uint32_t free_slot();
    DrawingOrder drawing_order() const;
    void append(Vec2 position, std::optional<double> explained, std::optional<double> left);
    void draw_new(std::size_t j);
    void use(Disc& disc, const DiscTemplates::Place& place);
    double move_to(std::size_t j, const DiscTemplates::Place& place);
    bool is_at(const Disc& disc, const DiscTemplates::Place& place) const;
    double move_to(std::size_t j, Vec2 to);
    std::pair<Redraw, float> redraw_for(const Disc& disc, Vec2 to) const;
    void redraw(std::size_t j, Drawing drawing);
    void redraw_all(const std::vector<std::uint32_t>& discs, Drawing drawing);
    double step(std::size_t j, double relaxation, double lag, Drawing drawing);
    double rough_step(std::size_t j, Vec2 d, double misfit);
    void take_step(std::size_t j, double relaxation, double lag, Drawing drawing);
    void in_tiles(const std::vector<std::uint32_t>& discs,
                  const std::function<void(const std::vector<std::uint32_t>&)>& body);
    std::vector<char> active_discs(double tolerance) const;

    DiscProfile profile_;
    int threads_;
    PaddedImage darkness_;
    PaddedImage transmission_;
    DiscStencil stencil_;
    DiscTemplates templates_;
    std::vector<Vec2> positions_;
    std::vector<Disc> discs_;
    HugeVector<HalfFloat> kept_;       ///< transmissions, stencil_.size() a slot
    std::vector<std::uint32_t> free_;  ///< slots given back
    std::uint32_t slots_ = 0;          ///< in use or given back
    std::vector<double> explained_;
    std::uint64_t revision_ = 0;
    bool some_undrawn_ = false;  ///< by more than the lag of exact sweeps, perhaps
    VisiblePixels visible_;
    double pixels_;
};

/// (A + λ)⁻¹ of one disc, λ = 1e-3 (tr A + 1): a Gauss–Newton step is its product with b. One that
/// is fully hidden has no information and stays where it is.
struct DampedInverse {
    double xx, xy, yy;  ///< [px²]

    explicit DampedInverse(const NormalEquations& information);
    Vec2 operator*(Vec2 b) const { return {xx * b.x + xy * b.y, xy * b.x + yy * b.y}; }
};

}  // namespace grainfield::tracking
