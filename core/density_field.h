#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/box.h"

namespace grainfield {

/// A density (or order) field on a regular grid at one instant: value at cell centres, row-major
/// with x fastest, `value[iy * nx + ix]` at (origin + (ix + 1/2, iy + 1/2) · spacing). A
/// one-dimensional field has ny = 1.
struct DensityField {
    std::int64_t step = 0;
    double time = 0;  ///< model time unit
    int nx = 0;
    int ny = 1;
    double spacing = 1;  ///< lattice constant δx [model length unit]
    std::array<Boundary, 2> boundary{Boundary::periodic, Boundary::periodic};
    std::vector<double> value;

    std::size_t size() const { return value.size(); }
    Box box() const { return {{0, 0}, {nx * spacing, ny * spacing}, boundary, 0}; }
};

}  // namespace grainfield
