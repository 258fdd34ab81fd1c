#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace grainfield::analysis {

/// The window by which a non-uniform Fourier transform spreads a particle over the cells around it,
/// exponential of a semicircle (`barnett2019`):
///
///   φ(z) = exp(β (sqrt(1 − (2z/w)²) − 1)),  |z| ≤ w/2,   z in cells, β = 2.3 w,
///
/// for grids twice as fine as the transform needs. Values at the w cells around a particle come
/// from one polynomial a cell, fitted when the kernel is made; those of mirror images share one.
class SpreadKernel {
 public:
    static constexpr int most_width = 16;
    static constexpr std::size_t padding = 4;  ///< coefficients come in groups of this many cells

    /// Errors of the transform of about `tolerance` (relative), which is held to 1e-1 … 1e-15.
    explicit SpreadKernel(double tolerance);

    int width() const { return width_; }
    std::size_t padded_width() const { return padded_; }
    /// Powers of t² in the even and in the odd part of a polynomial.
    int powers() const { return powers_; }

    /// [power of t² from the highest][even, odd part][cell]: the lower half of the cells, in whole
    /// groups of `padding`.
    const double* coefficients() const { return coefficients_.data(); }

    double value(double z) const;

    /// ∫ φ(z) cos(frequency · z) dz.
    double transform(double frequency) const;

 private:
    int width_;
    std::size_t padded_;
    int powers_;
    double beta_;
    std::vector<double> coefficients_;
};

/// A tile of the grid with room for the kernel on all sides.
struct SpreadTile {
    static constexpr std::size_t cells = 32;
    static constexpr std::size_t halo = SpreadKernel::most_width / 2;
    static constexpr std::size_t columns = 56;  // rows do not lie a power of two apart
    static constexpr std::size_t rows = 52;
    std::vector<double> value = std::vector<double>(columns * rows, 0.0);
};

/// Adds Σ_j w_j φ(cell − x_j) φ(row − y_j) to one tile for each kind of weights. x, y: in cells
/// from the corner of the tile proper, within [0, 32]; no weights: one tile, one each. One thread;
/// the order of the sum is that of the particles. Bits depend on the instruction set (fused
/// multiply-add), not on the machine beyond that. Cost about w² / 4 vector operations a particle
/// and tile, and as many for all tiles together.
void spread(const SpreadKernel& kernel, std::span<const double> x, std::span<const double> y,
            std::span<const std::span<const double>> weights, std::span<SpreadTile> tiles);

}  // namespace grainfield::analysis
