#pragma once

#include <array>
#include <cstdint>

#include "core/huge_pages.h"
#include "simulate/md/md_system.h"

namespace grainfield::simulate {

/// Cells at least one diameter wide that say who can be near whom. A grain sees its own cell and
/// those around it; periodic images are told apart by the shift of the cell, so that boxes of one
/// or two cells work too. The layer has one cell in z; tall boxes are divided there as well.
struct CellGrid {
    std::array<int, 3> count{1, 1, 1};
    std::array<double, 3> width{1, 1, 1};  ///< [a]
    std::array<bool, 3> periodic{};
    std::array<double, 3> length{};
    HugeVector<std::int32_t> head;  ///< first grain of each cell, −1: none; x fastest

    CellGrid() = default;
    explicit CellGrid(const MdSystem& system);

    std::size_t index(int x, int y, int z) const {
        return static_cast<std::size_t>((z * count[1] + y) * count[0] + x);
    }
    std::size_t size() const { return head.size(); }
    int coordinate(double position, int axis) const;
    bool is_inside(int x, int y, int z) const {
        const auto inner = [](int c, int n) {
            return static_cast<unsigned>(c - 1) < static_cast<unsigned>(n - 2);
        };
        return inner(x, count[0]) && inner(y, count[1]) && (count[2] == 1 || inner(z, count[2]));
    }
};

}  // namespace grainfield::simulate
