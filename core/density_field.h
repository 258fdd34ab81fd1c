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

/// The fields of one realisation at one instant.
struct FieldFrame {
    int dimension = 2;
    std::vector<DensityField> density;  ///< one a replica; all share the order field
    DensityField order;                 ///< ψ; no values where there is none
    double mean_diffusivity = 0;        ///< ⟨D⟩ over the cells
};

/// Receives fields one instant at a time, in order of time.
class FieldSink {
 public:
    virtual ~FieldSink() = default;
    virtual void write(const FieldFrame& frame) = 0;
};

/// Delivers fields one instant at a time, so that memory does not grow with their number.
class FieldSource {
 public:
    virtual ~FieldSource() = default;
    virtual std::int64_t count() const = 0;
    /// Instant number `index` in [0, count()), in order of time.
    virtual FieldFrame read(std::int64_t index) = 0;
};

}  // namespace grainfield
