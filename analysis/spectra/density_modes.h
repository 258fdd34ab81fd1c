#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "core/box.h"

namespace grainfield::analysis {

/// A wavevector k = (nx · dk.x, ny · dk.y) [1/a].
struct Mode {
    int nx = 0;
    int ny = 0;
    double k = 0;  ///< |k|
};

/// The wavevectors of one half plane with 0 < |k| ≤ k_max on a rectangular grid: nx > 0 with any
/// ny, and nx = 0 with ny > 0. (The other half plane holds the complex conjugates.)
class ModeGrid {
 public:
    /// `spacing` [1/a] > 0 on both axes. Throws OptionError if there would be more than 2^26 modes.
    ModeGrid(Vec2 spacing, double k_max);

    /// About how many modes there would be; never much fewer than there are.
    static double about(Vec2 spacing, double k_max);

    const std::vector<Mode>& modes() const { return modes_; }
    Vec2 spacing() const { return spacing_; }

    /// For each nx from 0, the number of ny ≥ 0 with |k| ≤ k_max.
    const std::vector<int>& rows() const { return rows_; }

    /// Index of mode (nx, ny), nx ≥ 0 and |ny| inside the row; nx = 0 needs ny > 0.
    std::size_t index(int nx, int ny) const;

 private:
    Vec2 spacing_;
    std::vector<int> rows_;
    std::vector<std::size_t> row_start_;
    std::vector<Mode> modes_;
};

/// The density modes of a pattern,
///
///   ρ_k = Σ_j exp(−i k·(r_j − origin)),
///
/// one per mode of the grid, in its order. Direct sum: powers of exp(−i dk x) per particle and
/// axis, multiplied as small real matrices over tiles of particles. Partial sums have a fixed
/// order, so the bits depend neither on threads nor on the instruction set. Relative error (to
/// sqrt(N)) about n_max · 1e-16 plus that of the coordinates.
///
/// `origin` [a]: subtract the corner of the box, so that nothing is lost far from zero.
/// Cost 4 N · (modes in the quadrant) multiply-adds. Thread-safe.
std::vector<std::complex<double>> density_modes(std::span<const Vec2> positions, Vec2 origin,
                                                const ModeGrid& grid);

/// Σ_j w_j exp(−i k·(r_j − origin)): the modes of a quantity that particles carry. As many weights
/// as positions.
std::vector<std::complex<double>> weighted_modes(std::span<const Vec2> positions,
                                                 std::span<const double> weights, Vec2 origin,
                                                 const ModeGrid& grid);

}  // namespace grainfield::analysis
