#include "tracking/refine/disc_sweeps.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <vector>

#include "tracking/refine/disc_kernel.h"
#include "tracking/refine/image_cells.h"

namespace grainfield::tracking {
namespace {

constexpr int kFullSteps = 30;         // sweeps; shorter steps after them
constexpr int kAttempts = 4;           // to find a step that lowers the misfit
constexpr double kShorter = 0.3;       // factor from one attempt to the next
constexpr double kMayRise = 1e-5;      // share of the misfit that is rounding
constexpr double kLeastMisfit = 1e-6;  // [contrast²]
constexpr double kFirstRoom = FittedDiscs::kLongestStep;

/// One step of one disc.
class Stepper {
 public:
    Stepper(FittedDiscs& discs, double lag, double relaxation, Drawing drawing)
        : scene_(discs.scene),
          position_(discs.position),
          motion_(discs.motion),
          lag_(lag),
          relaxation_(relaxation),
          drawing_(drawing) {}

    /// Takes a step and judges how much is left.
    void take(std::size_t j) {
        DiscMotion& motion = motion_[j];
        const auto done = static_cast<float>(step(j));
        motion.is_disturbed = true;
        // Steps that shrink by q each leave s (q + q² + …); next to one another discs may shrink
        // slowly.
        const bool is_first = motion.last_step == DiscMotion::kFresh || motion.last_step <= 0;
        const float q = is_first ? 1 : done / motion.last_step;
        motion.left = q < 0.5F ? done * q / (1 - q) : done;
        motion.last_step = done;
        motion.drift += done;
    }

 private:
    bool is_lower(double change, double misfit) const {
        return change <= kMayRise * (misfit + kLeastMisfit);
    }

    /// One damped Gauss–Newton step; the length of the displacement done. Steps up to the lag are
    /// not drawn.
    double step(std::size_t j) {
        const Vec2 start = position_[j];
        const Vec2 from = scene_[j].centre;
        const NormalEquations n = scene_.normal_equations(j);
        Vec2 d = relaxation_ * (DampedInverse(n) * Vec2{n.bx, n.by});
        // Steps shrink from sweep to sweep, so the last one says how much room the next needs.
        const double room = std::clamp(1.5 * static_cast<double>(motion_[j].last_step), kFirstRoom,
                                       longest_step(scene_.disc()));
        const double length = std::sqrt(squared_norm(d));
        if (length <= lag_) {
            position_[j] = scene_.inside(from + d);
            return norm(position_[j] - start);
        }
        if (length > room) d *= room / length;
        const bool is_rough = drawing_ == Drawing::roughly && scene_.has_templates();
        const std::optional<Vec2> end =
            is_rough ? end_of_rough_step(j, from, d, n.misfit) : end_of_step(j, from, d, n.misfit);
        position_[j] = end.value_or(from);
        return end ? norm(*end - start) : 0;
    }

    /// Empty if no step lowers the misfit: the disc is where it was drawn.
    std::optional<Vec2> end_of_step(std::size_t j, Vec2 from, Vec2 d, double misfit) {
        thread_local DiscScene::WayBack back;
        for (int attempt = 0; attempt < kAttempts; ++attempt) {
            const Vec2 to = scene_.inside(from + d);
            if (is_lower(scene_.move(j, to, back), misfit)) return to;
            scene_.move_back(j, back);
            d *= kShorter;
        }
        return std::nullopt;
    }

    /// The same to the template nearest to the end of step d.
    std::optional<Vec2> end_of_rough_step(std::size_t j, Vec2 from, Vec2 d, double misfit) {
        const DiscTemplates::Place back = scene_.place_of(j);
        const double square = 0.999 / scene_.templates_per_pixel();
        for (int attempt = 0; attempt < kAttempts; ++attempt) {
            const Vec2 to = scene_.inside(from + d);
            const DiscTemplates::Place place = scene_.nearest(to);
            const bool stays = scene_.is_at(j, place);
            if (stays || is_lower(scene_.move_to(j, place), misfit)) return to;
            if (back.number != DiscTemplates::kNone) {
                scene_.move_to(j, back);
            } else {
                scene_.move_to(j, from);
            }
            // From one template to the next the misfit may rise though the step is right: as far
            // as the edge of its square, then.
            if (squared_norm(d) <= 2 * square * square) {
                return from + Vec2{std::clamp(d.x, -square / 2, square / 2),
                                   std::clamp(d.y, -square / 2, square / 2)};
            }
            d *= kShorter;
        }
        return std::nullopt;
    }

    DiscScene& scene_;
    std::vector<Vec2>& position_;
    std::vector<DiscMotion>& motion_;
    double lag_;
    double relaxation_;
    Drawing drawing_;
};

/// Those that are restless or near one that is.
std::vector<std::uint32_t> active_discs(const FittedDiscs& discs, double tolerance) {
    const DiscProfile& disc = discs.scene.disc();
    const ImageCells cells(discs.scene.width(), discs.scene.height(),
                           disc.diameter + 2 * disc.edge_width);
    const std::vector<char> moving = cells.around(
        discs.position, [&](std::size_t j) { return discs.motion[j].is_restless(tolerance); });
    std::vector<std::uint32_t> active;
    for (std::uint32_t j = 0; j < discs.size(); ++j) {
        if (moving[cells.at(discs.position[j])] != 0) active.push_back(j);
    }
    return active;
}

/// One sweep over these discs; how many steps.
std::int64_t sweep_once(FittedDiscs& discs, const std::vector<std::uint32_t>& active,
                        double tolerance, double relaxation, Drawing drawing) {
    Stepper stepper(discs, tolerance, relaxation, drawing);
    std::atomic<std::int64_t> steps = 0;
    discs.in_tiles(active, [&](const std::vector<std::uint32_t>& tile) {
        for (std::size_t k = 0; k < tile.size(); ++k) {
            if (k + 1 < tile.size()) discs.scene.fetch(tile[k + 1]);
            stepper.take(tile[k]);
        }
        auto done = static_cast<std::int64_t>(tile.size());
        // While the tile is in the cache.
        for (int again = 0; again < FittedDiscs::kInnerSweeps; ++again) {
            for (const std::uint32_t j : tile) {
                if (!discs.motion[j].is_restless(tolerance)) continue;
                stepper.take(j);
                ++done;
            }
        }
        steps += done;
    });
    return steps;
}

}  // namespace

OptionTable describe(RefinementOptions& options) {
    OptionTable table("refine");
    table.number("tolerance", options.tolerance, "px", {1e-6, 1},
                 "a sphere rests when its refinement step is smaller than this");
    table.integer("max-sweeps", options.max_sweeps, "-", {1, 10000},
                  "most refinement sweeps over all spheres");
    return table;
}

RefinementOptions in_blocks(RefinementOptions options, Binning blocks) {
    options.tolerance /= blocks.factor;
    return options;
}

DampedInverse::DampedInverse(const NormalEquations& n) {
    const double damping = 1e-3 * (n.xx + n.yy) + 1e-3;
    const double a = n.xx + damping;
    const double b = n.yy + damping;
    const double determinant = a * b - n.xy * n.xy;
    xx = b / determinant;
    xy = -n.xy / determinant;
    yy = a / determinant;
}

SweepSummary sweep(FittedDiscs& discs, const RefinementOptions& options, Drawing drawing) {
    SweepSummary summary;
    for (; summary.sweeps < options.max_sweeps; ++summary.sweeps) {
        const std::vector<std::uint32_t> active = active_discs(discs, options.tolerance);
        summary.skipped += static_cast<std::int64_t>(discs.size() - active.size());
        if (active.empty()) return summary;
        ++discs.revision;
        if (discs.some_pending) {
            // A disc is compared with the image of all that share pixels with it.
            std::vector<Vec2> places;
            for (const std::uint32_t j : active) places.push_back(discs.position[j]);
            discs.draw_pending_near(places, 2 * discs.scene.disc().reach(), drawing);
        }
        // A few discs at the edge of what can be resolved would step to and fro for ever.
        const double relaxation = summary.sweeps < kFullSteps ? 1.0 : 0.5;
        summary.steps += sweep_once(discs, active, options.tolerance, relaxation, drawing);
        discs.some_pending = discs.some_pending || drawing == Drawing::roughly;
    }
    summary.unsettled = std::count_if(
        discs.motion.begin(), discs.motion.end(),
        [&](const DiscMotion& motion) { return motion.is_restless(options.tolerance); });
    return summary;
}

}  // namespace grainfield::tracking
