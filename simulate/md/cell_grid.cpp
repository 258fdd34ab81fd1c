#include "simulate/md/cell_grid.h"

#include <algorithm>
#include <cmath>

namespace grainfield::simulate {

namespace {

// A hair above one diameter, so that rounding cannot hide a contact across a cell.
constexpr double least_width = 1 + 1e-9;

// Lower boxes than this gain nothing from cells in z.
constexpr double tall = 3;

}  // namespace

CellGrid::CellGrid(const MdSystem& system) {
    length = {system.length.x, system.length.y, system.length.z};
    periodic = {!system.walls_x, !system.walls_y, system.vertical == Vertical::periodic};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        count[axis] = std::max(1, static_cast<int>(std::floor(length[axis] / least_width)));
        if (axis == 2 && !periodic[axis] && length[axis] < tall) count[axis] = 1;
        width[axis] = length[axis] / count[axis];
    }
    head.assign(static_cast<std::size_t>(count[0]) * static_cast<std::size_t>(count[1]) *
                    static_cast<std::size_t>(count[2]),
                -1);
}

int CellGrid::coordinate(double position, int axis) const {
    const auto a = static_cast<std::size_t>(axis);
    return std::clamp(static_cast<int>(std::floor(position / width[a])), 0, count[a] - 1);
}

}  // namespace grainfield::simulate
