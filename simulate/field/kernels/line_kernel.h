#pragma once

#include <cstddef>

namespace grainfield::simulate {

/// Lines that are solved side by side, one a vector lane.
inline constexpr int line_lanes = 16;

/// A bundle of `line_lanes` lines along which the implicit part of a diffusion step is solved:
/// number i of lane l stands at [i · stride + l].
struct LineBundle {
    int cells = 0;  ///< on the line
    /// Cells by which the elimination runs on beyond both ends, round the ring (see warm_up); 0:
    /// the ends are closed.
    int warm = 0;

    std::size_t length() const {
        const int all = cells + 2 * warm;
        return static_cast<std::size_t>(all);
    }
};

/// Coefficients of the elimination, filled by factor_lines; [length · line_lanes] numbers each.
template <class Real>
struct LineFactors {
    Real* upper;    ///< c_i = a_{i+1/2} / p_i
    Real* lower;    ///< e_i = a_{i−1/2} / p_i
    Real* inverse;  ///< 1 / p_i, the pivots
};

enum class AfterSolve {
    reflect,  ///< ρ ← 2q − ρ: Crank–Nicolson
    keep      ///< ρ ← q
};

/// Cells that the elimination must run beyond an end, so that what it started from has died out to
/// `epsilon`: the influence of a cell of the tridiagonal matrix 1 + A, 0 ≤ A ≤ 4a, decays by
/// (√κ − 1)/(√κ + 1) a cell, κ = 1 + 4a [demko1984]. `a` = D_max dt/(2 dx²).
int warm_up(double a, double epsilon);

/// Eliminates (1 + A) q = r,  (A q)_i = a_{i−1/2}(q_i − q_{i−1}) − a_{i+1/2}(q_{i+1} − q_i),
/// a_{i+1/2} = h (D_i + D_{i+1}), h = dt/(4 dx²): pivots p_i = 1 + a_{i−1/2} + a_{i+1/2} −
/// a_{i−1/2} c_{i−1} ≥ 1. The ring is solved as a line that begins `warm` cells early and ends as
/// much late: no second right-hand side, and no division by what may vanish.
template <class Real>
void factor_lines(const LineBundle& bundle, const Real* diffusivity, std::size_t stride, Real h,
                  const LineFactors<Real>& factors);

/// Solves for r_i = ρ_i + s (η_{i+1/2} − η_{i−1/2}), η_{i+1/2} at noise[i · line_lanes + l]
/// (noise null: r = ρ), and replaces ρ. `scratch`: length · line_lanes numbers.
template <class Real>
void solve_lines(const LineBundle& bundle, const LineFactors<Real>& factors, Real* rho,
                 std::size_t stride, const float* noise, Real s, Real* scratch, AfterSolve after);

/// Σ_i (q_{i+1} − q_i)² over the faces of each ring, summed over all lanes in double, where the
/// bundle holds q.
template <class Real>
double squared_differences(const LineBundle& bundle, const Real* q, std::size_t stride);

/// out[x · line_lanes + y] = in[y · in_stride + x] for x < columns (a multiple of line_lanes, or
/// rounded up to one: both arrays have the room) and y < rows; lanes from `rows` on become 0.
template <class Real>
void lanes_from_rows(const Real* in, std::size_t in_stride, int rows, int columns, Real* out);

/// The other way; lanes from `rows` on are dropped.
template <class Real>
void rows_from_lanes(const Real* in, int rows, int columns, Real* out, std::size_t out_stride);

}  // namespace grainfield::simulate
