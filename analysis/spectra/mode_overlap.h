#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>

#include "analysis/spectra/density_modes.h"

namespace grainfield::analysis {

/// Calls visit(m, m', c²) for each ordered pair of modes of the grid that overlap in a box of sides
/// `length` [a],
///
///   c = product over the axes of sin(x)/x,  x = Δk L/2,
///
/// a mode with itself (c² = 1) included; a mode of the other half plane is that of its conjugate.
/// |c|² is the correlation of |ρ_k|² and |ρ_k'|² for particles without structure: plane waves on
/// the π/L grid overlap, those on the 2π/L grid do not. Pairs more than 15 steps apart are left
/// out, below 2 % of the sum. Cost at most 256 visits a mode.
template <class Visit>
void for_overlaps(const ModeGrid& grid, Vec2 length, Visit visit) {
    constexpr int reach = 15;
    std::array<std::array<double, 2 * reach + 1>, 2> overlap{};
    const std::array<double, 2> half{0.5 * grid.spacing().x * length.x,
                                     0.5 * grid.spacing().y * length.y};
    for (std::size_t axis = 0; axis < 2; ++axis) {
        for (int d = -reach; d <= reach; ++d) {
            const double x = d * half[axis];
            const double c = d == 0 ? 1 : std::sin(x) / x;
            const int at = d + reach;
            overlap[axis][static_cast<std::size_t>(at)] = c * c < 1e-12 ? 0 : c * c;
        }
    }
    const auto& rows = grid.rows();
    for (std::size_t m = 0; m < grid.modes().size(); ++m) {
        for (std::size_t ix = 0; ix < overlap[0].size(); ++ix) {
            if (overlap[0][ix] == 0) continue;
            for (std::size_t iy = 0; iy < overlap[1].size(); ++iy) {
                if (overlap[1][iy] == 0) continue;
                int nx = grid.modes()[m].nx + static_cast<int>(ix) - reach;
                int ny = grid.modes()[m].ny + static_cast<int>(iy) - reach;
                if (nx < 0 || (nx == 0 && ny < 0)) {  // the other half plane: conjugate
                    nx = -nx;
                    ny = -ny;
                }
                if (nx >= static_cast<int>(rows.size()) || (nx == 0 && ny == 0)) continue;
                if (std::abs(ny) >= rows[static_cast<std::size_t>(nx)]) continue;
                visit(m, grid.index(nx, ny), overlap[0][ix] * overlap[1][iy]);
            }
        }
    }
}

}  // namespace grainfield::analysis
