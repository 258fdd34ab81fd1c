#include "tracking/refine/joint_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "tracking/refine/disc_kernel.h"

namespace grainfield::tracking {
namespace {

constexpr int kFullSteps = 30;
constexpr float kFresh = std::numeric_limits<float>::max();

/// A square grid over the image.
struct Grid {
    double cell;
    int columns, rows;

    Grid(const Image& image, double cell_size)
        : cell(cell_size),
          columns(static_cast<int>(image.width() / cell_size) + 1),
          rows(static_cast<int>(image.height() / cell_size) + 1) {}

    int column(double x) const { return std::clamp(static_cast<int>(x / cell), 0, columns - 1); }
    int row(double y) const { return std::clamp(static_cast<int>(y / cell), 0, rows - 1); }
    std::size_t index(int c, int r) const {
        return static_cast<std::size_t>(r) * static_cast<std::size_t>(columns) +
               static_cast<std::size_t>(c);
    }
    std::size_t size() const { return index(0, rows); }
};

}  // namespace

OptionTable describe(RefinementOptions& options) {
    OptionTable table("refine");
    table.number("tolerance", options.tolerance, "px", {1e-6, 1},
                 "a sphere rests when its refinement step is smaller than this");
    table.integer("max-sweeps", options.max_sweeps, "-", {1, 10000},
                  "most refinement sweeps over all spheres");
    return table;
}

JointFit::JointFit(const Image& darkness, const DiscProfile& disc, int threads)
    : darkness_(&darkness),
      disc_(disc),
      threads_(threads),
      transmission_(darkness.width(), darkness.height(), 1.0F) {}

void JointFit::add(Vec2 position) {
    positions_.push_back(position);
    last_step_.push_back(kFresh);
    place_disc(transmission_, position, disc_);
}

void JointFit::keep_only(const std::vector<char>& keep) {
    // Whoever looks at the gap next has to move again, so its neighbours count as fresh.
    const double near = 2 * disc_.reach();
    Grid grid(*darkness_, near);
    std::vector<char> disturbed(grid.size(), 0);
    for (std::size_t j = 0; j < positions_.size(); ++j) {
        if (keep[j]) continue;
        lift_disc(transmission_, positions_[j], disc_);
        const int c = grid.column(positions_[j].x);
        const int r = grid.row(positions_[j].y);
        for (int y = std::max(0, r - 1); y <= std::min(grid.rows - 1, r + 1); ++y) {
            for (int x = std::max(0, c - 1); x <= std::min(grid.columns - 1, c + 1); ++x) {
                disturbed[grid.index(x, y)] = 1;
            }
        }
    }
    std::size_t kept = 0;
    for (std::size_t j = 0; j < positions_.size(); ++j) {
        if (!keep[j]) continue;
        positions_[kept] = positions_[j];
        const bool near_gap =
            disturbed[grid.index(grid.column(positions_[j].x), grid.row(positions_[j].y))] != 0;
        last_step_[kept] = near_gap ? kFresh : last_step_[j];
        ++kept;
    }
    positions_.resize(kept);
    last_step_.resize(kept);
}

double JointFit::longest_step() const {
    return std::max(0.5, 0.15 * disc_.diameter);
}

/// One damped Gauss–Newton step of disc j; returns the displacement done.
Vec2 JointFit::step(std::size_t j, double relaxation) {
    const Vec2 from = positions_[j];
    const NormalEquations n = normal_equations(*darkness_, transmission_, from, disc_);
    // A fully hidden disc has no information; the damping keeps it where it is.
    const double damping = 1e-3 * (n.xx + n.yy) + 1e-3;
    const double xx = n.xx + damping;
    const double yy = n.yy + damping;
    const double determinant = xx * yy - n.xy * n.xy;
    Vec2 d{(yy * n.bx - n.xy * n.by) / determinant, (xx * n.by - n.xy * n.bx) / determinant};
    d *= relaxation;
    const double longest = longest_step();
    const double length = norm(d);
    if (length > longest) d *= longest / length;

    for (int attempt = 0; attempt < 4; ++attempt) {
        const Vec2 to{std::clamp(from.x + d.x, -0.5, darkness_->width() - 0.5),
                      std::clamp(from.y + d.y, -0.5, darkness_->height() - 0.5)};
        const double change = move_disc(*darkness_, transmission_, from, to, disc_);
        if (change <= 1e-5 * (n.misfit + 1e-6)) {
            positions_[j] = to;
            return to - from;
        }
        move_disc(*darkness_, transmission_, to, from, disc_);
        d *= 0.3;
    }
    return {};
}

std::vector<char> JointFit::active_discs(double tolerance) const {
    const Grid grid(*darkness_, disc_.diameter + 2 * disc_.edge_width);
    std::vector<char> moving(grid.size(), 0);
    for (std::size_t j = 0; j < positions_.size(); ++j) {
        if (static_cast<double>(last_step_[j]) > tolerance) {
            moving[grid.index(grid.column(positions_[j].x), grid.row(positions_[j].y))] = 1;
        }
    }
    std::vector<char> active(positions_.size(), 0);
    for (std::size_t j = 0; j < positions_.size(); ++j) {
        const int c = grid.column(positions_[j].x);
        const int r = grid.row(positions_[j].y);
        for (int y = std::max(0, r - 1); y <= std::min(grid.rows - 1, r + 1); ++y) {
            for (int x = std::max(0, c - 1); x <= std::min(grid.columns - 1, c + 1); ++x) {
                if (moving[grid.index(x, y)]) active[j] = 1;
            }
        }
    }
    return active;
}

void JointFit::sweep(const std::vector<char>& active, double relaxation) {
    // A disc writes at most reach + one step beyond its tile, so two tiles of one colour, one tile
    // apart, never touch the same pixel.
    const Grid tiles(*darkness_, std::max(64.0, 2 * (disc_.reach() + longest_step()) + 4));
    std::vector<std::vector<std::uint32_t>> members(tiles.size());
    for (std::size_t j = 0; j < positions_.size(); ++j) {
        if (!active[j]) {
            last_step_[j] = 0;
            continue;
        }
        members[tiles.index(tiles.column(positions_[j].x), tiles.row(positions_[j].y))].push_back(
            static_cast<std::uint32_t>(j));
    }
    for (int colour = 0; colour < 4; ++colour) {
        std::vector<std::size_t> work;
        for (int r = colour / 2; r < tiles.rows; r += 2) {
            for (int c = colour % 2; c < tiles.columns; c += 2) {
                if (!members[tiles.index(c, r)].empty()) work.push_back(tiles.index(c, r));
            }
        }
        parallel_for(static_cast<std::int64_t>(work.size()), threads_, [&](std::int64_t i) {
            for (const std::uint32_t j : members[work[static_cast<std::size_t>(i)]]) {
                last_step_[j] = static_cast<float>(norm(step(j, relaxation)));
            }
        });
    }
}

JointFit::Summary JointFit::refine(const RefinementOptions& options) {
    Summary summary;
    for (; summary.sweeps < options.max_sweeps; ++summary.sweeps) {
        const std::vector<char> active = active_discs(options.tolerance);
        const auto count = std::count(active.begin(), active.end(), char{1});
        summary.skipped += static_cast<std::int64_t>(active.size()) - count;
        if (count == 0) return summary;
        summary.steps += count;
        // A few discs at the edge of what can be resolved would step to and fro for ever.
        sweep(active, summary.sweeps < kFullSteps ? 1.0 : 0.5);
    }
    summary.unsettled = std::count_if(last_step_.begin(), last_step_.end(), [&](float step) {
        return static_cast<double>(step) > options.tolerance;
    });
    return summary;
}

std::vector<double> JointFit::explained() const {
    std::vector<double> gain(positions_.size());
    parallel_for(static_cast<std::int64_t>(gain.size()), threads_, [&](std::int64_t i) {
        const auto j = static_cast<std::size_t>(i);
        gain[j] = explained_misfit(*darkness_, transmission_, positions_[j], disc_);
    });
    return gain;
}

std::vector<JointFit::Uncertainty> JointFit::uncertainties() const {
    std::vector<Uncertainty> result(positions_.size());
    parallel_for(static_cast<std::int64_t>(result.size()), threads_, [&](std::int64_t i) {
        const auto j = static_cast<std::size_t>(i);
        const NormalEquations n = normal_equations(*darkness_, transmission_, positions_[j], disc_);
        const double determinant = n.determinant();
        const double nan = std::numeric_limits<double>::quiet_NaN();
        // Σ_xx = (A⁻¹)_xx; no number where the disc is hidden.
        const bool resolved = determinant > 1e-6 * (n.xx + n.yy) * (n.xx + n.yy);
        result[j].error = resolved
                              ? Vec2{std::sqrt(n.yy / determinant), std::sqrt(n.xx / determinant)}
                              : Vec2{nan, nan};
        result[j].residual = n.pixels > 0 ? std::sqrt(n.misfit / n.pixels) : nan;
    });
    return result;
}

double JointFit::residual_rms() const {
    double sum = 0;
    for (std::size_t i = 0; i < transmission_.size(); ++i) {
        const double r =
            static_cast<double>(darkness_->pixels()[i] - 1.0F + transmission_.pixels()[i]);
        sum += r * r;
    }
    return transmission_.empty() ? 0 : std::sqrt(sum / static_cast<double>(transmission_.size()));
}

}  // namespace grainfield::tracking
