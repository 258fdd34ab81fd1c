#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/frame.h"
#include "core/vec2.h"
#include "tracking/model/disc_profile.h"
#include "tracking/model/padded_image.h"
#include "tracking/model/visible_pixels.h"
#include "tracking/refine/disc_scene.h"
#include "tracking/refine/disc_sweeps.h"
#include "tracking/refine/fitted_discs.h"

namespace grainfield::tracking {

/// The positions of all discs of one frame, fitted together.
///
/// Least squares on the product of transmissions, M = 1 − Π_j (1 − P_j), over all positions at
/// once. refine() takes Gauss–Seidel sweeps (disc_sweeps.h), displace() a joint Newton step
/// (joint_information.h); both change the discs drawn (disc_scene.h). Fixed points of either are
/// those of the joint problem. A step may be pending: the position is known, and the disc is still
/// drawn where it was before. Results do not depend on the number of threads.
class JointFit {
 public:
    using WriteRow = DiscScene::WriteRow;
    using Summary = SweepSummary;

    /// The rows of the image may be `spacing` pixels apart: enough for the first steps of a fit at
    /// a fraction of their cost.
    JointFit(const Image& darkness, const DiscProfile& disc, int threads, int spacing = 1);

    /// Begins anew, without discs, on an image of the same size; memory is kept.
    void restart(const Image& darkness);
    /// On the image whose rows `write_row` writes, rows in parallel.
    void restart(const WriteRow& write_row);
    /// The same discs on another image of that size. Each may have to move, by about `left` [px],
    /// as in add_all(); nothing is known of what it explains.
    void look_at(const Image& darkness, double left);
    /// From the next restart on.
    void set_visible(VisiblePixels visible) { discs_.scene.set_visible(std::move(visible)); }
    void set_threads(int threads) { discs_.threads = threads; }
    int threads() const { return discs_.threads; }

    /// The discs as they are drawn.
    const DiscScene& scene() const { return discs_.scene; }
    const PaddedImage& darkness() const { return scene().darkness(); }
    const PaddedImage& transmission() const { return scene().transmission(); }
    const DiscProfile& disc() const { return scene().disc(); }
    /// Goes up with everything that is drawn.
    std::uint64_t revision() const { return discs_.revision; }
    /// Goes up when discs come, go, or are put elsewhere.
    std::uint64_t arrangement() const { return arrangement_; }

    void add(Vec2 position);
    /// Many at once, in parallel, each at the nearest template. `explained`: what each disc is
    /// known to explain, until something near it moves; empty: unknown. `left`: how far they are
    /// expected to be from where they belong [px]; those nearer than the tolerance take no step.
    void add_all(const std::vector<Vec2>& positions, const std::vector<double>& explained = {},
                 std::optional<double> left = {});
    /// What is done with the discs of one of scene().parts() parts of the frame.
    using Visit = DrawingOrder::Visit;
    /// add_all() on an empty fit. Each part is visited as soon as all discs that share pixels with
    /// its own are drawn, while these pixels are in the cache. Parts are visited in parallel.
    void add_all(const std::vector<Vec2>& positions, const std::vector<double>& explained,
                 std::optional<double> left, const Visit& visit);
    /// The same visits to discs that are drawn.
    void in_parts(const Visit& visit) const {
        scene().drawing_order().visit(discs_.threads, visit);
    }
    void move(std::size_t j, Vec2 to);
    /// Removes the discs whose entry in `keep` is zero.
    void keep_only(const std::vector<char>& keep);

    const std::vector<Vec2>& positions() const { return discs_.position; }
    /// How far a disc would move in its next step, judged from the last two [px].
    double step_left(std::size_t j) const { return static_cast<double>(discs_.motion[j].left); }
    /// That step is longer than the tolerance [px].
    bool is_restless(std::size_t j, double tolerance) const {
        return discs_.motion[j].is_restless(tolerance);
    }

    /// Sweeps until all discs rest. Roughly: discs are drawn at the nearest template, and come to
    /// rest up to that much from where they would; a joint step mends it.
    Summary refine(const RefinementOptions& options, Drawing drawing = Drawing::exactly) {
        return sweep(discs_, options, drawing);
    }

    /// A displacement of all discs at once, from where they are drawn.
    struct Displacement {
        std::vector<Vec2> step;   ///< [px]
        std::vector<float> left;  ///< known to be left of it [px]
    };
    static constexpr double kLongestStep = FittedDiscs::kLongestStep;  ///< [px]
    /// Moves every disc, by kLongestStep at most. Discs that would go farther are restless: the
    /// next refine() moves them again. With `check_far` those that go by more than `far` are, too.
    /// Steps shorter than `least_drawn` [px] stay pending. How many went by more than `far` [px].
    std::int64_t displace(const Displacement& all, double least_drawn, double far,
                          bool check_far = false);
    /// Discs that share edge pixels with one that has moved in another way than by a displacement
    /// of less than `far`, since the last call, and these discs themselves.
    std::vector<char> collect_disturbed();

    /// From where a disc is drawn to where it is [px].
    Vec2 pending_step(std::size_t j) const { return discs_.pending_step(j); }
    /// Draws all discs where they are …
    void draw_pending() { discs_.draw_pending(); }
    /// … nearer than `range` to one of these places [px].
    void draw_pending_near(const std::vector<Vec2>& places, double range) {
        discs_.draw_pending_near(places, range, Drawing::exactly);
    }

    /// Σ (I − M)² that each disc explains (drawn_disc.h, explained). Discs in whose neighbourhood
    /// nothing has moved by more than 0.2 px since the last call keep their value.
    const std::vector<double>& explained();

    /// RMS of I − M about each disc [contrast]; NaN without pixels.
    struct Residuals {
        std::vector<double> within_reach;
        std::vector<double> at_edge;  ///< weighted with |∂M/∂r|², as a position is read from it
        std::vector<double> edge_pixels;  ///< how many such a mean is of, (Σw)²/Σw²; 0: none
    };
    /// `gain`: by how much pending steps lower the misfit about each disc [contrast²].
    Residuals residuals(const std::vector<double>& gain = {}) const;
    /// RMS of I − M over the visible pixels of the frame, likewise [contrast].
    double residual_rms(const std::vector<double>& gain = {}) const;

 private:
    FittedDiscs discs_;
    std::uint64_t arrangement_ = 0;
    std::vector<double> explained_;
};

}  // namespace grainfield::tracking
