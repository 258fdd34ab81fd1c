#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "simulate/field/kernels/aligned_vector.h"
#include "simulate/field/kernels/line_kernel.h"
#include "simulate/field/model/lattice.h"

namespace grainfield::simulate {

/// Solves the implicit part of a step along all lines of a bundle of rows, of columns, or along the
/// single ring of a one-dimensional lattice, in place. Cut into bundles the same way for any
/// number of threads; buffers belong to the calling thread.
template <class Real>
class LineSweep {
 public:
    using Array = AlignedVector<Real>;
    /// Fills the face noises of replica `replica` on line bundle `line`.
    using Noise = std::function<void(int replica, std::uint32_t line, std::span<float> out)>;

    /// `a_max` = dt D_max/(2 dx²); `h` = dt/(4 dx²); `s`: factor of the noise differences in the
    /// right-hand side (0: none).
    LineSweep(const Lattice& lattice, double a_max, double h, double s, AfterSolve after);

    static int bundles(int lines) { return (lines + line_lanes - 1) / line_lanes; }

    /// Bundle `bundle` of 16 rows, lines along x. Where `squares` is not empty, the squared
    /// differences across all faces of q = (before + after)/2 are added to squares[field]
    /// (AfterSolve::reflect, no noise).
    void rows(int bundle, const Array& diffusivity, std::span<Array> fields, const Noise& noise,
              std::span<double> squares = {}) const;
    /// Bundle `bundle` of 16 columns, lines along y.
    void columns(int bundle, const Array& diffusivity, std::span<Array> fields, const Noise& noise,
                 std::span<double> squares = {}) const;
    /// The ring of a one-dimensional lattice, cut into 16 overlapping parts solved side by side.
    void ring(const Array& diffusivity, std::span<Array> fields, const Noise& noise,
              std::span<double> squares = {}) const;

    int warm() const { return warm_; }

 private:
    struct Buffers;
    static Buffers& buffers();
    double solve(const LineBundle& lines, const LineFactors<Real>& factors, Real* field,
                 std::size_t stride, const float* noise, bool squared) const;

    Lattice lattice_;
    Real h_;
    Real s_;
    AfterSolve after_;
    int warm_;
};

extern template class LineSweep<float>;
extern template class LineSweep<double>;

}  // namespace grainfield::simulate
