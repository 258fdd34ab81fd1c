#include "simulate/field/field_size.h"

#include <algorithm>

namespace grainfield::simulate {

namespace {

constexpr double bytes_of_all = 36;
constexpr double bytes_of_density = 29;
constexpr double bytes_of_order = 21;
constexpr double bytes_of_double = 16;
constexpr double bytes_of_adjoint = 32;
constexpr double seconds_of_cell = 7e-9;
// Below this a thread more gains nothing.
constexpr double cells_of_thread = 16384;

}  // namespace

JobSize size_of(const FieldOptions& options) {
    const LatticeOptions& lattice = options.lattice;
    const SchemeOptions& scheme = options.scheme;
    const RecordOptions& record = options.record;
    const double rows = lattice.dimension == 1 ? 1 : lattice.ny == 0 ? lattice.nx : lattice.ny;
    const double cells = lattice.nx * rows;
    const double densities = scheme.scheme == SchemeChoice::adjoint ? 1 : record.replicas;
    const bool twofold = scheme.precision == Precision::twofold ||
                         (scheme.precision == Precision::automatic && scheme.tolerance < 1e-4);
    double bytes = bytes_of_all + densities * bytes_of_density;
    if (options.model.lambda > 0) bytes += bytes_of_order;
    if (twofold) bytes += bytes_of_double;
    if (scheme.scheme == SchemeChoice::adjoint) bytes += bytes_of_adjoint;
    const double steps = (record.relax + record.record) / scheme.dt;
    const double threads =
        lattice.dimension == 1
            ? 1
            : std::clamp(cells / cells_of_thread, 1.0, std::max(1.0, 1.0 * options.threads));
    return {.bytes = cells * bytes,
            .seconds = steps * cells * seconds_of_cell * (twofold ? 2 : 1) *
                       (0.5 + 0.5 * densities) / threads};
}

}  // namespace grainfield::simulate
