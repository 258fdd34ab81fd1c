#include "analysis/spectra/density_transform.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>
#include <utility>
#include <vector>

#include "core/support/fourier.h"

namespace grainfield::analysis {
namespace {

constexpr std::size_t cells = SpreadTile::cells;

int size_for(int n_max, int width) {
    return fast_fourier_size(std::max(2 * (2 * n_max + 1), 2 * width));
}

int most_of(const std::vector<int>& rows) {
    return *std::ranges::max_element(rows) - 1;
}

// Transforms that no thread works with: planning one takes as long as using it, and threads come
// and go with every batch of frames. Never destroyed, so that no order of destruction matters.
struct IdleTransforms {
    std::mutex mutex;
    std::vector<std::unique_ptr<RealFourier2D<double>>> idle;
};

IdleTransforms& idle_transforms() {
    static auto* const transforms = new IdleTransforms;
    return *transforms;
}

std::unique_ptr<RealFourier2D<double>> take_transform(int nx, int ny) {
    {
        IdleTransforms& transforms = idle_transforms();
        const std::lock_guard lock(transforms.mutex);
        for (auto& transform : transforms.idle) {
            if (transform->nx() != nx || transform->ny() != ny) continue;
            std::swap(transform, transforms.idle.back());
            auto taken = std::move(transforms.idle.back());
            transforms.idle.pop_back();
            return taken;
        }
    }
    return std::make_unique<RealFourier2D<double>>(nx, ny);
}

void give_back(std::unique_ptr<RealFourier2D<double>> transform) {
    constexpr std::size_t most = 64;  // of the sizes used last
    IdleTransforms& transforms = idle_transforms();
    const std::lock_guard lock(transforms.mutex);
    if (transforms.idle.size() >= most) transforms.idle.erase(transforms.idle.begin());
    transforms.idle.push_back(std::move(transform));
}

// Into [0, n).
double wrapped(double u, double n) {
    if (u >= 0 && u < n) return u;
    const double w = u - n * std::floor(u / n);
    return w < n ? w : 0;
}

// Adds a tile to the periodic grid.
void add_tile(const SpreadTile& tile, std::size_t tx, std::size_t ty, int nx, int ny,
              std::span<double> grid) {
    const auto index = [](std::size_t tile_of, std::size_t cell, int n) {
        const auto size = static_cast<std::size_t>(n);
        // Some periods up, so that the halo's cells below zero have an index.
        return (tile_of * cells + cell + size * SpreadTile::halo - SpreadTile::halo) % size;
    };
    const std::size_t first = index(tx, 0, nx);
    const auto columns = static_cast<std::size_t>(nx);
    for (std::size_t row = 0; row < SpreadTile::rows; ++row) {
        double* to = &grid[index(ty, row, ny) * columns];
        const double* from = &tile.value[row * SpreadTile::columns];
        std::size_t at = first;
        for (std::size_t c = 0; c < SpreadTile::columns;) {
            const std::size_t run = std::min(SpreadTile::columns - c, columns - at);
            for (std::size_t i = 0; i < run; ++i) to[at + i] += from[c + i];
            c += run;
            at = 0;
        }
    }
}

}  // namespace

// Particles in the order of their tiles.
struct NonuniformFourier::Sorted {
    std::vector<double> x, y;  // cells from the corner of the tile
    std::vector<std::vector<double>> weights;
    std::vector<std::size_t> start;  // of each tile, and the end
};

bool NonuniformFourier::is_affordable(const ModeGrid& grid) {
    constexpr double most = 1 << 24;
    const double x = 4.0 * static_cast<double>(grid.rows().size());
    const double y = 4.0 * most_of(grid.rows());
    return x * y < most;
}

NonuniformFourier::NonuniformFourier(const ModeGrid& grid, double tolerance)
    : kernel_(tolerance),
      nx_(size_for(static_cast<int>(grid.rows().size()) - 1, kernel_.width())),
      ny_(size_for(most_of(grid.rows()), kernel_.width())),
      tiles_x_((static_cast<std::size_t>(nx_) + cells - 1) / cells),
      tiles_y_((static_cast<std::size_t>(ny_) + cells - 1) / cells) {
    const auto fill = [this](std::vector<double>& factor, int n_max, int n) {
        for (int i = 0; i <= n_max; ++i) {
            factor.push_back(1 / kernel_.transform(2 * std::numbers::pi * i / n));
        }
    };
    fill(factor_x_, static_cast<int>(grid.rows().size()) - 1, nx_);
    fill(factor_y_, most_of(grid.rows()), ny_);
}

NonuniformFourier::Sorted NonuniformFourier::sort(std::span<const Vec2> positions, Weights weights,
                                                  Vec2 origin, Vec2 spacing) const {
    const double to_x = nx_ * spacing.x / (2 * std::numbers::pi);
    const double to_y = ny_ * spacing.y / (2 * std::numbers::pi);
    const std::size_t n = positions.size();
    std::vector<Vec2> place(n);
    std::vector<std::uint32_t> tile(n);
    Sorted sorted;
    sorted.start.assign(tiles_x_ * tiles_y_ + 1, 0);
    for (std::size_t j = 0; j < n; ++j) {
        place[j] = {wrapped((positions[j].x - origin.x) * to_x, nx_),
                    wrapped((positions[j].y - origin.y) * to_y, ny_)};
        const std::size_t tx = static_cast<std::size_t>(place[j].x) / cells;
        const std::size_t ty = static_cast<std::size_t>(place[j].y) / cells;
        place[j].x -= static_cast<double>(tx * cells);
        place[j].y -= static_cast<double>(ty * cells);
        tile[j] = static_cast<std::uint32_t>(ty * tiles_x_ + tx);
        ++sorted.start[tile[j] + 1];
    }
    for (std::size_t t = 1; t < sorted.start.size(); ++t) sorted.start[t] += sorted.start[t - 1];
    std::vector<std::size_t> next(sorted.start.begin(), sorted.start.end() - 1);
    sorted.x.resize(n);
    sorted.y.resize(n);
    sorted.weights.assign(weights.size(), std::vector<double>(n));
    for (std::size_t j = 0; j < n; ++j) {
        const std::size_t to = next[tile[j]]++;
        sorted.x[to] = place[j].x;
        sorted.y[to] = place[j].y;
        for (std::size_t c = 0; c < weights.size(); ++c) sorted.weights[c][to] = weights[c][j];
    }
    return sorted;
}

std::vector<std::complex<double>> NonuniformFourier::modes(std::span<const Vec2> positions,
                                                           Weights weights, Vec2 origin,
                                                           const ModeGrid& grid) const {
    const std::size_t kinds = std::max<std::size_t>(1, weights.size());
    std::vector<std::unique_ptr<RealFourier2D<double>>> transforms;
    for (std::size_t c = 0; c < kinds; ++c) {
        transforms.push_back(take_transform(nx_, ny_));
        std::ranges::fill(transforms.back()->real(), 0.0);
    }
    const Sorted sorted = sort(positions, weights, origin, grid.spacing());
    std::vector<SpreadTile> tiles(kinds);
    std::vector<std::span<const double>> parts(weights.size());
    for (std::size_t ty = 0; ty < tiles_y_; ++ty) {
        for (std::size_t tx = 0; tx < tiles_x_; ++tx) {
            const std::size_t from = sorted.start[ty * tiles_x_ + tx];
            const std::size_t count = sorted.start[ty * tiles_x_ + tx + 1] - from;
            if (count == 0) continue;
            for (SpreadTile& tile : tiles) std::ranges::fill(tile.value, 0.0);
            for (std::size_t c = 0; c < parts.size(); ++c) {
                parts[c] = std::span(sorted.weights[c]).subspan(from, count);
            }
            spread(kernel_, std::span(sorted.x).subspan(from, count),
                   std::span(sorted.y).subspan(from, count), parts, tiles);
            for (std::size_t c = 0; c < kinds; ++c) {
                add_tile(tiles[c], tx, ty, nx_, ny_, transforms[c]->real());
            }
        }
    }
    const std::size_t columns = static_cast<std::size_t>(nx_) / 2 + 1;
    std::vector<std::complex<double>> rho;
    rho.reserve(kinds * grid.modes().size());
    for (auto& transform : transforms) {
        transform->forward();
        const auto of_grid = transform->complex();
        for (const Mode& mode : grid.modes()) {
            const auto row = static_cast<std::size_t>(mode.ny < 0 ? mode.ny + ny_ : mode.ny);
            const auto nx = static_cast<std::size_t>(mode.nx);
            const auto abs_ny = static_cast<std::size_t>(std::abs(mode.ny));
            rho.push_back(factor_x_[nx] * factor_y_[abs_ny] * of_grid[row * columns + nx]);
        }
        give_back(std::move(transform));
    }
    return rho;
}

DensityTransform::DensityTransform(const ModeGrid& grid) {
    double quadrant = 0;
    double powers = 0;
    for (const int row : grid.rows()) quadrant += row;
    powers = static_cast<double>(grid.rows().size()) + most_of(grid.rows());
    // Nanoseconds a particle, one thread (bench/results/analysis.md).
    per_particle_ = 55 + 0.3 * quadrant + 0.2 * powers;
    if (!grid.modes().empty() && NonuniformFourier::is_affordable(grid)) fourier_.emplace(grid);
}

bool DensityTransform::is_direct(std::size_t particles) const {
    if (!fourier_) return true;
    const double n = static_cast<double>(particles);
    const double cells_of_grid = static_cast<double>(fourier_->nx()) * fourier_->ny();
    const double transform = 85 * n + cells_of_grid * (1.0 + 0.2 * std::log2(cells_of_grid));
    return per_particle_ * n < transform;
}

std::vector<std::complex<double>> DensityTransform::modes(std::span<const Vec2> positions,
                                                          Weights weights, Vec2 origin,
                                                          const ModeGrid& grid) const {
    if (!is_direct(positions.size())) return fourier_->modes(positions, weights, origin, grid);
    if (weights.empty()) return density_modes(positions, origin, grid);
    std::vector<std::complex<double>> rho;
    for (const std::span<const double> kind : weights) {
        const auto part = weighted_modes(positions, kind, origin, grid);
        rho.insert(rho.end(), part.begin(), part.end());
    }
    return rho;
}

}  // namespace grainfield::analysis
