#include "tracking/refine/joint_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"

namespace grainfield::tracking {
namespace {

constexpr int kFullSteps = 30;
constexpr float kFresh = std::numeric_limits<float>::max();
constexpr float kUnmoved = 0.05F;
constexpr double kLeastRoom = 0.25;
// Two images of this size and their surroundings stay in the second-level cache.
constexpr double kTile = 128;

/// A square grid over the image.
struct Grid {
    double cell;
    int columns, rows;

    Grid(const PaddedImage& image, double cell_size)
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
    std::size_t at(Vec2 p) const { return index(column(p.x), row(p.y)); }
};

/// Cells in which a point fulfils the condition, and all their neighbours.
template <class Condition>
std::vector<char> cells_around(const Grid& grid, const std::vector<Vec2>& points,
                               Condition&& condition) {
    std::vector<char> marked(grid.size(), 0);
    for (std::size_t j = 0; j < points.size(); ++j) {
        if (!condition(j)) continue;
        const int c = grid.column(points[j].x);
        const int r = grid.row(points[j].y);
        for (int y = std::max(0, r - 1); y <= std::min(grid.rows - 1, r + 1); ++y) {
            for (int x = std::max(0, c - 1); x <= std::min(grid.columns - 1, c + 1); ++x) {
                marked[grid.index(x, y)] = 1;
            }
        }
    }
    return marked;
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

JointFit::JointFit(const Image& darkness, const DiscProfile& disc, int threads)
    : disc_(disc),
      threads_(threads),
      darkness_(padded_darkness(darkness, disc)),
      transmission_(clear_transmission(darkness.width(), darkness.height(), disc)) {}

void JointFit::add(Vec2 position, std::optional<double> explained) {
    positions_.push_back(position);
    last_step_.push_back(kFresh);
    explained_.push_back(explained.value_or(0));
    drift_.push_back(explained ? 0 : kFresh);
    place_disc(transmission_, position, disc_);
}

void JointFit::move(std::size_t j, Vec2 to) {
    lift_disc(transmission_, positions_[j], disc_);
    place_disc(transmission_, to, disc_);
    positions_[j] = to;
    last_step_[j] = kFresh;
    drift_[j] = kFresh;
}

void JointFit::keep_only(const std::vector<char>& keep) {
    // Whoever looks at the gap next has to move again, so its neighbours count as fresh.
    const Grid grid(darkness_, 2 * disc_.reach());
    const std::vector<char> disturbed =
        cells_around(grid, positions_, [&](std::size_t j) { return keep[j] == 0; });
    std::size_t kept = 0;
    for (std::size_t j = 0; j < positions_.size(); ++j) {
        if (!keep[j]) {
            lift_disc(transmission_, positions_[j], disc_);
            continue;
        }
        const bool near_gap = disturbed[grid.at(positions_[j])] != 0;
        positions_[kept] = positions_[j];
        last_step_[kept] = near_gap ? kFresh : last_step_[j];
        explained_[kept] = explained_[j];
        drift_[kept] = near_gap ? kFresh : drift_[j];
        ++kept;
    }
    positions_.resize(kept);
    last_step_.resize(kept);
    explained_.resize(kept);
    drift_.resize(kept);
}

/// One damped Gauss–Newton step of disc j; returns the displacement done.
Vec2 JointFit::step(std::size_t j, double relaxation) {
    thread_local DiscWindow window;
    const Vec2 from = positions_[j];
    // Steps shrink from sweep to sweep, so the last one says how much room the next needs.
    const double room =
        std::clamp(1.5 * static_cast<double>(last_step_[j]), kLeastRoom, longest_step(disc_));
    window.enclose(darkness_, from, disc_.reach() + room);
    const NormalEquations n = linearise(darkness_, transmission_, from, disc_, window);
    // A fully hidden disc has no information; the damping keeps it where it is.
    const double damping = 1e-3 * (n.xx + n.yy) + 1e-3;
    const double xx = n.xx + damping;
    const double yy = n.yy + damping;
    const double determinant = xx * yy - n.xy * n.xy;
    Vec2 d{(yy * n.bx - n.xy * n.by) / determinant, (xx * n.by - n.xy * n.bx) / determinant};
    d *= relaxation;
    const double length = norm(d);
    if (length > room) d *= room / length;

    for (int attempt = 0; attempt < 4; ++attempt) {
        const Vec2 to{std::clamp(from.x + d.x, -0.5, darkness_.width() - 0.5),
                      std::clamp(from.y + d.y, -0.5, darkness_.height() - 0.5)};
        const double change = shift_disc(darkness_, transmission_, to, disc_, window);
        if (change <= 1e-5 * (n.misfit + 1e-6)) {
            positions_[j] = to;
            return to - from;
        }
        undo_shift(transmission_, window);
        d *= 0.3;
    }
    return {};
}

std::vector<char> JointFit::active_discs(double tolerance) const {
    const Grid grid(darkness_, disc_.diameter + 2 * disc_.edge_width);
    const std::vector<char> moving = cells_around(grid, positions_, [&](std::size_t j) {
        return static_cast<double>(last_step_[j]) > tolerance;
    });
    std::vector<char> active(positions_.size());
    for (std::size_t j = 0; j < positions_.size(); ++j) active[j] = moving[grid.at(positions_[j])];
    return active;
}

void JointFit::sweep(const std::vector<char>& active, double relaxation) {
    // A disc writes at most reach + one step (and the rest of a vector) beyond its tile, so two
    // tiles of one colour, one tile apart, never touch the same pixel.
    const Grid tiles(darkness_, std::max(kTile, 2 * (disc_.reach() + longest_step(disc_)) + 4 +
                                                    PaddedImage::kMostLanes));
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
            const std::vector<std::uint32_t>& tile = members[work[static_cast<std::size_t>(i)]];
            for (std::size_t k = 0; k < tile.size(); ++k) {
                if (k + 1 < tile.size()) {
                    fetch_window(darkness_, transmission_, positions_[tile[k + 1]], disc_.reach());
                }
                const std::uint32_t j = tile[k];
                last_step_[j] = static_cast<float>(norm(step(j, relaxation)));
                drift_[j] += last_step_[j];
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

const std::vector<double>& JointFit::explained() {
    const Grid grid(darkness_, 2 * disc_.reach());
    const std::vector<char> moved =
        cells_around(grid, positions_, [&](std::size_t j) { return drift_[j] > kUnmoved; });
    parallel_for(static_cast<std::int64_t>(positions_.size()), threads_, [&](std::int64_t i) {
        const auto j = static_cast<std::size_t>(i);
        if (moved[grid.at(positions_[j])] == 0) return;
        explained_[j] = explained_misfit(darkness_, transmission_, positions_[j], disc_);
    });
    for (float& drift : drift_) {
        if (drift > kUnmoved) drift = 0;
    }
    return explained_;
}

std::vector<double> JointFit::residuals() const {
    std::vector<double> rms(positions_.size());
    parallel_for(static_cast<std::int64_t>(rms.size()), threads_, [&](std::int64_t i) {
        const auto j = static_cast<std::size_t>(i);
        rms[j] = local_residual(darkness_, transmission_, positions_[j], disc_);
    });
    return rms;
}

double JointFit::residual_rms() const {
    double sum = 0;
    for (int y = 0; y < darkness_.height(); ++y) {
        const float* d = darkness_.row(y);
        const float* t = transmission_.row(y);
        float row = 0;
#pragma omp simd reduction(+ : row)
        for (int x = 0; x < darkness_.width(); ++x) {
            const float r = d[x] - 1.0F + t[x];
            row += r * r;
        }
        sum += static_cast<double>(row);
    }
    const double n = static_cast<double>(darkness_.width()) * darkness_.height();
    return n > 0 ? std::sqrt(sum / n) : 0;
}

}  // namespace grainfield::tracking
