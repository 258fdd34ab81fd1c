#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "analysis/spectra/density_modes.h"
#include "analysis/spectra/spread_kernel.h"

namespace grainfield::analysis {

/// Kinds of weights, each one a particle; none: every particle counts one.
using Weights = std::span<const std::span<const double>>;

/// Density modes by a non-uniform Fourier transform of the first type (`dutt1993`, `barnett2019`):
/// particles are spread over a grid at least twice as fine as the modes need, which a fast Fourier
/// transform takes to wavevectors, where the spreading is divided out.
///
///   ρ_k = Σ_j w_j exp(−i k·(r_j − origin)) with an error of about `tolerance` · sqrt(Σ_j w_j²)
///
/// (tests hold it at random particles and at a lattice). Particles lie on the torus of 2π/dk.
/// Cost O(N w²) + O(modes ln modes), w the number of digits and one.
class NonuniformFourier {
 public:
    explicit NonuniformFourier(const ModeGrid& grid, double tolerance = 1e-12);

    /// One per mode of `grid`, which is the one the transform was made for, of each kind of weights
    /// after the other. Thread-safe; the same bits in any thread.
    std::vector<std::complex<double>> modes(std::span<const Vec2> positions, Weights weights,
                                            Vec2 origin, const ModeGrid& grid) const;

    int nx() const { return nx_; }
    int ny() const { return ny_; }
    const SpreadKernel& kernel() const { return kernel_; }

    /// Whether the grid behind it takes at most 2^24 numbers.
    static bool is_affordable(const ModeGrid& grid);

 private:
    struct Sorted;
    Sorted sort(std::span<const Vec2> positions, Weights weights, Vec2 origin, Vec2 spacing) const;

    SpreadKernel kernel_;
    int nx_, ny_;
    std::size_t tiles_x_, tiles_y_;
    std::vector<double> factor_x_, factor_y_;  // of |n|
};

/// The density modes of patterns by whichever way is faster for them: the direct sum
/// (`density_modes`) or the non-uniform transform.
///
/// The choice is by a model of the measured cost (bench/results/analysis.md), not by a clock, so
/// that the same input gives the same bits on every run.
class DensityTransform {
 public:
    explicit DensityTransform(const ModeGrid& grid);

    /// As `density_modes`, or `weighted_modes` of each kind of weights after the other; relative
    /// error 1e-12. Thread-safe.
    std::vector<std::complex<double>> modes(std::span<const Vec2> positions, Weights weights,
                                            Vec2 origin, const ModeGrid& grid) const;

    /// Whether so many particles are summed directly.
    bool is_direct(std::size_t particles) const;

 private:
    double per_particle_ = 0;  // of the direct sum [ns]
    std::optional<NonuniformFourier> fourier_;
};

}  // namespace grainfield::analysis
