#include "simulate/md/engine/cell_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

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
        const double most = std::floor(length[axis] / least_width);
        count[axis] = static_cast<int>(std::clamp(most, 1.0, double{most_per_axis}));
        if (axis == 2 && !periodic[axis] && length[axis] < tall) count[axis] = 1;
    }
    while (static_cast<double>(count[0]) * count[1] * count[2] > most_cells) {
        int& longest = *std::max_element(count.begin(), count.end());
        longest = (longest + 1) / 2;
    }
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        width[axis] = length[axis] / count[axis];
        for (int c = 0; c <= count[axis]; ++c) edge[axis].push_back(c * width[axis]);
        edge[axis].front() = periodic[axis] ? 0 : -infinity;
        edge[axis].back() = periodic[axis] ? length[axis] : infinity;
    }
    cell.assign(static_cast<std::size_t>(count[0]) * static_cast<std::size_t>(count[1]) *
                    static_cast<std::size_t>(count[2]),
                {});
}

int CellGrid::coordinate(double position, int axis) const {
    const auto a = static_cast<std::size_t>(axis);
    return std::clamp(static_cast<int>(std::floor(position / width[a])), 0, count[a] - 1);
}

void CellGrid::link(std::size_t at, std::int32_t i, HugeVector<Grain>& grains) {
    Cell& c = cell[at];
    std::int32_t& place = c.id[static_cast<std::size_t>(std::min(c.count, Cell::places - 1))];
    grains[static_cast<std::size_t>(i)].next = place;
    place = i;
    ++c.count;
}

void CellGrid::unlink(std::size_t at, std::int32_t i, HugeVector<Grain>& grains) {
    Cell& c = cell[at];
    const auto next = [&grains](std::int32_t j) -> std::int32_t& {
        return grains[static_cast<std::size_t>(j)].next;
    };
    const std::int32_t filled = std::min(c.count, Cell::places);
    --c.count;
    std::int32_t& last = c.id[static_cast<std::size_t>(filled - 1)];
    for (std::size_t k = 0; k + 1 < c.id.size(); ++k) {
        if (c.id[k] != i) continue;
        c.id[k] = last;
        last = filled == Cell::places ? next(last) : -1;
        return;
    }
    std::int32_t* slot = &last;
    while (*slot != i) slot = &next(*slot);
    *slot = next(i);
}

}  // namespace grainfield::simulate
