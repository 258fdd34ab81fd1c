#pragma once

#include <cstddef>

namespace grainfield::simulate {

/// Noises on the faces round the cells of a row: x[i] between cells i and i + 1 (periodic), below
/// and above on the faces to the rows before and after.
struct RowNoise {
    const float* x;
    const float* below;
    const float* above;
};

/// z_i = ρ_i + s (x_i − x_{i−1} + above_i − below_i).
template <class Real>
void add_row_noise(const Real* rho, const RowNoise& noise, Real s, int nx, Real* z);

/// A row with its neighbours.
template <class Real>
struct RowStencil {
    const Real* below;
    const Real* here;
    const Real* above;
};

/// out_i = base_i + h_x [(D_i + D_{i+1})(z_{i+1} − z_i) − (D_{i−1} + D_i)(z_i − z_{i−1})] + the
/// same along y with h_y; x is periodic. `out` may be `base`.
template <class Real>
void add_row_diffusion(const Real* base, const RowStencil<Real>& z, const RowStencil<Real>& d,
                       Real h_x, Real h_y, int nx, Real* out);

/// out_i = 2 z_i − ρ_i.
template <class Real>
void reflect_row(const Real* z, const Real* rho, int nx, Real* out);

}  // namespace grainfield::simulate
