#pragma once

#include <cstddef>

namespace grainfield::simulate {

/// The grid of a run and how its rows lie in memory: `stride` numbers from row to row, of which
/// the first nx count; the rest is padding, so that vectors never end inside a row.
struct Lattice {
    int dimension = 2;
    int nx = 0;
    int ny = 1;
    double spacing = 1;

    static constexpr int padding = 16;

    std::size_t stride() const {
        return (static_cast<std::size_t>(nx) + padding - 1) / padding * padding;
    }
    std::size_t cells() const {
        return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny);
    }
    std::size_t padded_cells() const { return stride() * static_cast<std::size_t>(ny); }
    double cell_volume() const { return dimension == 1 ? spacing : spacing * spacing; }
    double volume() const { return cell_volume() * static_cast<double>(cells()); }
};

}  // namespace grainfield::simulate
