#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/support/huge_pages.h"
#include "simulate/md/mechanics/flight.h"
#include "simulate/md/state/md_system.h"

namespace grainfield::simulate {

/// The grains of a cell: three in place, so that the list of further ones is nearly always
/// empty. That list begins at the third and is linked by Grain::next.
struct alignas(16) Cell {
    static constexpr std::int32_t places = 3;
    std::array<std::int32_t, places> id{-1, -1, -1};
    std::int32_t count = 0;
};

/// Cells at least one diameter wide that give the possible neighbours. A grain sees its own cell
/// and those around it. Periodic images are told apart by the shift of the cell, so boxes of one or
/// two cells work too. The layer has one cell in z; tall boxes are divided there as well. Boxes of
/// more than `most_cells` get wider ones.
struct CellGrid {
    std::array<int, 3> count{1, 1, 1};
    std::array<double, 3> width{1, 1, 1};  ///< [a]
    std::array<bool, 3> periodic{};
    std::array<double, 3> length{};
    /// [a], of each axis: the lower edges of its cells, then the end of the box. At a wall or plate
    /// it is -inf or inf, since no grain leaves there. Not used in z under gravity.
    std::array<std::vector<double>, 3> edge;
    HugeVector<Cell> cell;  ///< x fastest

    static constexpr double most_cells = 1.6e7;  // 256 MB
    static constexpr int most_per_axis = 60000;  // Plan::cell has 16 bits an axis

    CellGrid() = default;
    explicit CellGrid(const MdSystem& system);

    std::size_t index(int x, int y, int z) const {
        const int index = (z * count[1] + y) * count[0] + x;
        return static_cast<std::size_t>(index);
    }
    std::size_t size() const { return cell.size(); }
    int coordinate(double position, int axis) const;
    void link(std::size_t at, std::int32_t i, HugeVector<Grain>& grains);
    void unlink(std::size_t at, std::int32_t i, HugeVector<Grain>& grains);

    /// As many as copy() takes. More have no room in a cell as it stands, but the lowest and the
    /// highest cells also hold what a plate has carried beyond them.
    static constexpr std::int32_t most_in_cell = 32;

    /// Writes the grains of cell `at`, which holds no more than `most_in_cell`, to `out`; their
    /// number. Room for Cell::places more than there are is needed.
    std::size_t copy(std::size_t at, const HugeVector<Grain>& grains, std::int32_t* out) const {
        const Cell& c = cell[at];
        for (std::size_t k = 0; k < c.id.size(); ++k) out[k] = c.id[k];
        for (std::int32_t k = Cell::places; k < c.count; ++k) {
            out[k] = grains[static_cast<std::size_t>(out[k - 1])].next;
        }
        return static_cast<std::size_t>(c.count);
    }

    template <class F>
    void for_each(std::size_t at, const HugeVector<Grain>& grains, F&& f) const {
        const Cell& c = cell[at];
        std::int32_t i = -1;
        for (std::int32_t k = 0; k < c.count; ++k) {
            i = k < Cell::places ? c.id[static_cast<std::size_t>(k)]
                                 : grains[static_cast<std::size_t>(i)].next;
            f(i);
        }
    }
    bool is_inside(int x, int y, int z) const {
        const auto inner = [](int c, int n) {
            return static_cast<unsigned>(c - 1) < static_cast<unsigned>(n - 2);
        };
        return inner(x, count[0]) && inner(y, count[1]) && (count[2] == 1 || inner(z, count[2]));
    }
};

}  // namespace grainfield::simulate
