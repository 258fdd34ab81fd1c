#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "core/support/line_fourier.h"
#include "core/support/team.h"
#include "simulate/field/kernels/aligned_vector.h"
#include "simulate/field/model/order_spectrum.h"
#include "simulate/noise.h"

namespace grainfield::simulate {

/// The order field ψ as independent Fourier modes c_k (OrderSpectrum), with noise drawn in Fourier
/// space: one inverse transform a step and no forward one.
///
/// Modes are complex Gaussians, real and imaginary part with half the variance each; the
/// self-conjugate ones are real with all of it; columns kx = 0 and (nx even) nx/2 are
/// conjugate-symmetric in ky. The transform runs over the columns that are kept, then over pairs
/// of rows packed into one complex line (row y as real, row y + 1 as imaginary part). Columns and
/// pairs are cut the same way for any number of threads, so the bits do not depend on it. A lattice
/// of one row has modes along x only: they lie side by side and share one line of noise.
template <class Real>
class OrderField {
 public:
    OrderField(const Lattice& lattice, OrderSpectrum spectrum, std::uint64_t seed);

    /// Draws the stationary state (step 0); modes that have none start at 0.
    void draw_stationary();
    /// One step of all modes with the noise of step `step` ≥ 1; after that rows can be read.
    void advance(std::uint64_t step, Team& team);
    /// Makes the rows those of the present modes (after draw_stationary or set_modes).
    void transform_columns(Team& team);

    static constexpr int rows_at_once = 16;
    /// Room that a thread needs to read rows.
    struct Scratch {
        explicit Scratch(const Lattice& lattice);
        int nx;
        std::size_t distance;  // from line to line
        AlignedVector<std::complex<Real>> packed, line;
    };
    /// ψ on rows [first, first + rows_at_once), `first` a multiple of rows_at_once; rows beyond the
    /// lattice are left alone. `out` has the lattice's stride.
    void read_rows(int first, Scratch& scratch, Real* out) const;

    const OrderSpectrum& spectrum() const { return spectrum_; }
    /// Real and imaginary part of every mode that is kept, for checkpoints.
    std::vector<double> modes() const;
    void set_modes(const std::vector<double>& modes);

 private:
    std::size_t negative_rows(int kx) const;
    bool is_symmetric(int kx) const { return kx == 0 || 2 * kx == lattice_.nx; }
    bool is_one_row() const { return lattice_.ny == 1; }
    void fill_coefficients();
    void update_row(std::uint64_t step);
    void update_column(int kx, std::uint64_t step);
    void transform_column(int kx);
    void read_one_row(Scratch& scratch, Real* out) const;
    void mirror(int kx);

    Lattice lattice_;
    OrderSpectrum spectrum_;
    NoiseStream noise_;
    std::size_t distance_;  // from column to column
    LineFourier<Real> along_y_;
    LineFourier<Real> along_x_;
    AlignedVector<std::complex<Real>> modes_;        // [kx][ky]
    AlignedVector<std::complex<Real>> transformed_;  // [kx][y]
    AlignedVector<Real> loss_, amplitude_;           // of each component in modes_
};

extern template class OrderField<float>;
extern template class OrderField<double>;

}  // namespace grainfield::simulate
