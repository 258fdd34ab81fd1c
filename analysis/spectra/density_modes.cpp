#include "analysis/spectra/density_modes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::analysis {
namespace {

constexpr std::size_t tile = 256;  // particles; both power tables of 64 modes stay in L2
constexpr double most_modes = 1 << 26;

// Four doubles; the compiler lowers it to whatever the instruction set of the function offers.
using Lanes = double __attribute__((vector_size(32)));
constexpr std::size_t lanes = 4;

// cos(n φ_j) and −sin(n φ_j) for n = 0 … count − 1 and the particles j of a tile: row n is
// [re of tile][im of tile].
class PowerTable {
 public:
    explicit PowerTable(std::size_t count) : count_(count), value_(2 * tile * count + lanes) {}

    double* re(std::size_t n) { return aligned() + 2 * tile * n; }
    double* im(std::size_t n) { return re(n) + tile; }
    std::size_t count() const { return count_; }

 private:
    double* aligned() {
        const auto address = reinterpret_cast<std::uintptr_t>(value_.data());
        const std::size_t misfit = (address / sizeof(double)) % lanes;
        return value_.data() + (misfit == 0 ? 0 : lanes - misfit);
    }
    std::size_t count_;
    std::vector<double> value_;
};

const Lanes* as_lanes(const double* p) {
    return reinterpret_cast<const Lanes*>(p);
}

[[gnu::always_inline]] inline double total(const Lanes& v) {
    return (v[0] + v[1]) + (v[2] + v[3]);
}

// Row n from row n − 1 and row 1.
[[gnu::always_inline]] inline void raise(PowerTable& table) {
    const double* first_re = table.re(1);
    const double* first_im = table.im(1);
    for (std::size_t n = 2; n < table.count(); ++n) {
        const double* from_re = table.re(n - 1);
        const double* from_im = table.im(n - 1);
        double* to_re = table.re(n);
        double* to_im = table.im(n);
        for (std::size_t j = 0; j < tile; ++j) {
            to_re[j] = from_re[j] * first_re[j] - from_im[j] * first_im[j];
            to_im[j] = from_re[j] * first_im[j] + from_im[j] * first_re[j];
        }
    }
}

// The four products of one pair of rows, summed over the tile.
using Quad = std::array<double, 4>;  // re·re, im·im, re·im, im·re

template <std::size_t columns>
[[gnu::always_inline]] inline void multiply(PowerTable& x, PowerTable& y, std::size_t nx,
                                            std::size_t ny, Quad* sums) {
    const Lanes* xr = as_lanes(x.re(nx));
    const Lanes* xi = as_lanes(x.im(nx));
    const Lanes* y0r = as_lanes(y.re(ny));
    const Lanes* y0i = as_lanes(y.im(ny));
    const Lanes* y1r = as_lanes(y.re(ny + columns - 1));
    const Lanes* y1i = as_lanes(y.im(ny + columns - 1));
    Lanes rr0 = {}, ii0 = {}, ri0 = {}, ir0 = {}, rr1 = {}, ii1 = {}, ri1 = {}, ir1 = {};
    for (std::size_t j = 0; j < tile / lanes; ++j) {
        rr0 += xr[j] * y0r[j];
        ii0 += xi[j] * y0i[j];
        ri0 += xr[j] * y0i[j];
        ir0 += xi[j] * y0r[j];
        if constexpr (columns == 2) {
            rr1 += xr[j] * y1r[j];
            ii1 += xi[j] * y1i[j];
            ri1 += xr[j] * y1i[j];
            ir1 += xi[j] * y1r[j];
        }
    }
    const auto add = [](Quad & to, const Lanes& rr, const Lanes& ii, const Lanes& ri,
                        const Lanes& ir) __attribute__((always_inline)) {
        to[0] += total(rr);
        to[1] += total(ii);
        to[2] += total(ri);
        to[3] += total(ir);
    };
    add(sums[0], rr0, ii0, ri0, ir0);
    if constexpr (columns == 2) add(sums[1], rr1, ii1, ri1, ir1);
}

// `weights`: of the particles of the tile; null: one each.
[[gnu::always_inline]] inline void add_tile(PowerTable& x, PowerTable& y, const double* weights,
                                            const std::vector<int>& rows, Quad* sums) {
    raise(x);
    raise(y);
    for (std::size_t n = 0; weights != nullptr && n < x.count(); ++n) {
        double* re = x.re(n);
        double* im = x.im(n);
        for (std::size_t j = 0; j < tile; ++j) {
            re[j] *= weights[j];
            im[j] *= weights[j];
        }
    }
    for (std::size_t nx = 0; nx < rows.size(); ++nx) {
        const auto count = static_cast<std::size_t>(rows[nx]);
        std::size_t ny = 0;
        for (; ny + 2 <= count; ny += 2) multiply<2>(x, y, nx, ny, sums + ny);
        if (ny < count) multiply<1>(x, y, nx, ny, sums + ny);
        sums += count;
    }
}

void add_tile_plain(PowerTable& x, PowerTable& y, const double* weights,
                    const std::vector<int>& rows, Quad* sums) {
    add_tile(x, y, weights, rows, sums);
}

#if defined(__x86_64__) && defined(__GNUC__)
[[gnu::target("avx2")]] void add_tile_avx2(PowerTable& x, PowerTable& y, const double* weights,
                                           const std::vector<int>& rows, Quad* sums) {
    add_tile(x, y, weights, rows, sums);
}
const auto best_add_tile = __builtin_cpu_supports("avx2") != 0 ? add_tile_avx2 : add_tile_plain;
#else
const auto best_add_tile = add_tile_plain;
#endif

// Rows 0 and 1 of the tables; particles beyond the end weigh nothing.
void start(PowerTable& table, std::span<const Vec2> part, double Vec2::*axis, double origin,
           double dk) {
    for (std::size_t j = 0; j < tile; ++j) {
        const bool inside = j < part.size();
        const double phase = inside ? dk * (part[j].*axis - origin) : 0;
        table.re(0)[j] = inside ? 1 : 0;
        table.im(0)[j] = 0;
        table.re(1)[j] = inside ? std::cos(phase) : 0;
        table.im(1)[j] = inside ? -std::sin(phase) : 0;
    }
}

// Without weights every particle counts one.
std::vector<std::complex<double>> modes_of(std::span<const Vec2> positions,
                                           std::span<const double> weights, Vec2 origin,
                                           const ModeGrid& grid) {
    const std::vector<int>& rows = grid.rows();
    std::size_t quadrant = 0;
    for (int count : rows) quadrant += static_cast<std::size_t>(count);
    std::vector<Quad> sums(quadrant, Quad{});
    PowerTable x(std::max<std::size_t>(rows.size(), 2));
    const int y_most = *std::max_element(rows.begin(), rows.end());
    PowerTable y(std::max<std::size_t>(static_cast<std::size_t>(y_most), 2));
    std::array<double, tile> weight{};
    for (std::size_t first = 0; first < positions.size(); first += tile) {
        const auto part = positions.subspan(first, std::min(tile, positions.size() - first));
        start(x, part, &Vec2::x, origin.x, grid.spacing().x);
        start(y, part, &Vec2::y, origin.y, grid.spacing().y);
        std::copy_n(weights.begin() + static_cast<std::ptrdiff_t>(weights.empty() ? 0 : first),
                    weights.empty() ? 0 : part.size(), weight.begin());
        best_add_tile(x, y, weights.empty() ? nullptr : weight.data(), rows, sums.data());
    }

    // exp(−i(a + b)) = (ca cb − sa sb) + i(ca·(−sb) + (−sa)·cb), and the same with −b.
    std::vector<std::complex<double>> rho(grid.modes().size());
    std::size_t at = 0;
    for (std::size_t row = 0; row < rows.size(); ++row) {
        const int nx = static_cast<int>(row);
        for (int ny = 0; ny < rows[row]; ++ny, ++at) {
            const auto& [rr, ii, ri, ir] = sums[at];
            if (nx == 0 && ny == 0) continue;
            rho[grid.index(nx, ny)] = {rr - ii, ri + ir};
            if (nx > 0 && ny > 0) rho[grid.index(nx, -ny)] = {rr + ii, ir - ri};
        }
    }
    return rho;
}

}  // namespace

double ModeGrid::about(Vec2 spacing, double k_max) {
    // Half an ellipse and its two axes.
    const double x = k_max / spacing.x;
    const double y = k_max / spacing.y;
    return std::numbers::pi / 2 * x * y + x + y;
}

ModeGrid::ModeGrid(Vec2 spacing, double k_max) : spacing_(spacing) {
    if (const double count = about(spacing, k_max); !(count < most_modes)) {
        throw OptionError(ErrorText{"too many wavevectors for S(k)",
                                    fmt::format("about {:.2g}", count),
                                    fmt::format("at most {:.2g}", most_modes), "lower sk.k-max"});
    }
    // Rounding must not drop a mode that lies on the circle.
    const double limit = k_max * (1 + 1e-12);
    const int nx_max = static_cast<int>(std::floor(limit / spacing.x));
    for (int nx = 0; nx <= nx_max; ++nx) {
        const double kx = nx * spacing.x;
        const double ky_max = std::sqrt(std::max(0.0, limit * limit - kx * kx));
        const int ny_max = static_cast<int>(std::floor(ky_max / spacing.y));
        rows_.push_back(ny_max + 1);
        row_start_.push_back(modes_.size());
        for (int ny = nx == 0 ? 1 : -ny_max; ny <= ny_max; ++ny) {
            modes_.push_back({nx, ny, std::hypot(kx, ny * spacing.y)});
        }
    }
}

std::size_t ModeGrid::index(int nx, int ny) const {
    const auto row = static_cast<std::size_t>(nx);
    const int first = nx == 0 ? 1 : 1 - rows_[row];
    return row_start_[row] + static_cast<std::size_t>(ny - first);
}

std::vector<std::complex<double>> density_modes(std::span<const Vec2> positions, Vec2 origin,
                                                const ModeGrid& grid) {
    return modes_of(positions, {}, origin, grid);
}

std::vector<std::complex<double>> weighted_modes(std::span<const Vec2> positions,
                                                 std::span<const double> weights, Vec2 origin,
                                                 const ModeGrid& grid) {
    return modes_of(positions, weights, origin, grid);
}

}  // namespace grainfield::analysis
