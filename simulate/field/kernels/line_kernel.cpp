#include "simulate/field/kernels/line_kernel.h"

#include <algorithm>
#include <cmath>

// The order of these matters.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simulate/field/kernels/line_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace grainfield::simulate::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t lanes = line_lanes;

template <class Real>
using Tag = hn::CappedTag<Real, lanes>;

template <class Real>
constexpr std::size_t vectors() {
    return lanes / hn::MaxLanes(Tag<Real>());
}

template <class D>
HWY_INLINE hn::Vec<D> widen(D, const float* from, float) {
    return hn::LoadU(D(), from);
}

template <class D>
HWY_INLINE hn::Vec<D> widen(D d, const float* from, double) {
    return hn::PromoteTo(d, hn::LoadU(hn::Rebind<float, D>(), from));
}

// Position on the ring of cell i − warm, for i growing by one.
class RingWalk {
 public:
    RingWalk(const LineBundle& bundle, int start) : cells_(bundle.cells) {
        at_ = (start % cells_ + cells_) % cells_;
    }
    std::size_t at() const { return static_cast<std::size_t>(at_); }
    void up() { at_ = at_ + 1 == cells_ ? 0 : at_ + 1; }
    void down() { at_ = (at_ == 0 ? cells_ : at_) - 1; }

 private:
    int cells_;
    int at_;
};

template <class Real>
HWY_INLINE void factor(const LineBundle& bundle, const Real* HWY_RESTRICT diffusivity,
                       std::size_t stride, Real h, const LineFactors<Real>& factors) {
    const Tag<Real> d;
    using V = hn::Vec<Tag<Real>>;
    constexpr std::size_t n = vectors<Real>();
    constexpr std::size_t width = lanes / n;
    const auto one = hn::Set(d, Real{1});
    const auto vh = hn::Set(d, h);
    V here[n], left[n], above[n];
    RingWalk walk(bundle, -bundle.warm);
    for (std::size_t v = 0; v < n; ++v) {
        here[v] = hn::LoadU(d, diffusivity + walk.at() * stride + v * width);
        left[v] = hn::Zero(d);
        above[v] = hn::Zero(d);
    }
    const std::size_t length = bundle.length();
    for (std::size_t i = 0; i < length; ++i) {
        walk.up();
        const bool last = i + 1 == length;
        for (std::size_t v = 0; v < n; ++v) {
            const auto next = hn::LoadU(d, diffusivity + walk.at() * stride + v * width);
            const auto right = last ? hn::Zero(d) : hn::Mul(vh, hn::Add(here[v], next));
            const auto pivot =
                hn::Add(hn::Add(one, right), hn::NegMulAdd(left[v], above[v], left[v]));
            const auto inverse = hn::Div(one, pivot);
            above[v] = hn::Mul(right, inverse);
            const std::size_t to = i * lanes + v * width;
            hn::StoreU(above[v], d, factors.upper + to);
            hn::StoreU(hn::Mul(left[v], inverse), d, factors.lower + to);
            hn::StoreU(inverse, d, factors.inverse + to);
            here[v] = next;
            left[v] = right;
        }
    }
}

template <class Real, bool noisy>
HWY_INLINE void eliminate(const LineBundle& bundle, const LineFactors<Real>& factors,
                          const Real* HWY_RESTRICT rho, std::size_t stride,
                          const float* HWY_RESTRICT noise, Real s, Real* HWY_RESTRICT y) {
    const Tag<Real> d;
    using V = hn::Vec<Tag<Real>>;
    constexpr std::size_t n = vectors<Real>();
    constexpr std::size_t width = lanes / n;
    const auto vs = hn::Set(d, s);
    RingWalk walk(bundle, -bundle.warm);
    V before[n], low[n];
    for (std::size_t v = 0; v < n; ++v) {
        before[v] = hn::Zero(d);
        low[v] = hn::Zero(d);
        if constexpr (noisy) {
            RingWalk face(bundle, -bundle.warm - 1);
            if (bundle.warm > 0) {
                low[v] = widen(d, noise + face.at() * lanes + v * width, Real{});
            }
        }
    }
    const std::size_t length = bundle.length();
    for (std::size_t i = 0; i < length; ++i, walk.up()) {
        for (std::size_t v = 0; v < n; ++v) {
            auto r = hn::LoadU(d, rho + walk.at() * stride + v * width);
            if constexpr (noisy) {
                const auto high = widen(d, noise + walk.at() * lanes + v * width, Real{});
                r = hn::MulAdd(vs, hn::Sub(high, low[v]), r);
                low[v] = high;
            }
            const std::size_t at = i * lanes + v * width;
            before[v] = hn::MulAdd(hn::LoadU(d, factors.lower + at), before[v],
                                   hn::Mul(r, hn::LoadU(d, factors.inverse + at)));
            hn::StoreU(before[v], d, y + at);
        }
    }
}

template <class Real, bool reflect>
HWY_INLINE void substitute(const LineBundle& bundle, const LineFactors<Real>& factors,
                           const Real* HWY_RESTRICT y, Real* HWY_RESTRICT rho, std::size_t stride) {
    const Tag<Real> d;
    using V = hn::Vec<Tag<Real>>;
    constexpr std::size_t n = vectors<Real>();
    constexpr std::size_t width = lanes / n;
    V after[n];
    for (std::size_t v = 0; v < n; ++v) after[v] = hn::Zero(d);
    const auto warm = static_cast<std::size_t>(bundle.warm);
    const auto cells = static_cast<std::size_t>(bundle.cells);
    for (std::size_t i = bundle.length(); i-- > warm;) {
        const bool inside = i < warm + cells;
        for (std::size_t v = 0; v < n; ++v) {
            const std::size_t at = i * lanes + v * width;
            after[v] = hn::MulAdd(hn::LoadU(d, factors.upper + at), after[v], hn::LoadU(d, y + at));
            if (!inside) continue;
            Real* to = rho + (i - warm) * stride + v * width;
            if constexpr (reflect) {
                hn::StoreU(hn::Sub(hn::Add(after[v], after[v]), hn::LoadU(d, to)), d, to);
            } else {
                hn::StoreU(after[v], d, to);
            }
        }
    }
}

template <class Real>
HWY_INLINE void solve(const LineBundle& bundle, const LineFactors<Real>& factors, Real* rho,
                      std::size_t stride, const float* noise, Real s, Real* scratch,
                      AfterSolve after) {
    if (noise != nullptr) {
        eliminate<Real, true>(bundle, factors, rho, stride, noise, s, scratch);
    } else {
        eliminate<Real, false>(bundle, factors, rho, stride, nullptr, s, scratch);
    }
    if (after == AfterSolve::reflect) {
        substitute<Real, true>(bundle, factors, scratch, rho, stride);
    } else {
        substitute<Real, false>(bundle, factors, scratch, rho, stride);
    }
}

// Squares of 4 numbers of 4 rows become 4 lanes of 4 numbers, in registers.
HWY_INLINE void transpose_square(const float* HWY_RESTRICT in, std::size_t in_stride,
                                 float* HWY_RESTRICT out, std::size_t out_stride) {
#if HWY_TARGET == HWY_SCALAR
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) out[j * out_stride + i] = in[i * in_stride + j];
    }
#else
    const hn::FixedTag<float, 4> d;
    const hn::FixedTag<double, 2> dd;
    const auto a = hn::LoadU(d, in);
    const auto b = hn::LoadU(d, in + in_stride);
    const auto c = hn::LoadU(d, in + 2 * in_stride);
    const auto e = hn::LoadU(d, in + 3 * in_stride);
    const auto ab = hn::BitCast(dd, hn::InterleaveLower(d, a, b));
    const auto ab_high = hn::BitCast(dd, hn::InterleaveUpper(d, a, b));
    const auto ce = hn::BitCast(dd, hn::InterleaveLower(d, c, e));
    const auto ce_high = hn::BitCast(dd, hn::InterleaveUpper(d, c, e));
    hn::StoreU(hn::BitCast(d, hn::InterleaveLower(dd, ab, ce)), d, out);
    hn::StoreU(hn::BitCast(d, hn::InterleaveUpper(dd, ab, ce)), d, out + out_stride);
    hn::StoreU(hn::BitCast(d, hn::InterleaveLower(dd, ab_high, ce_high)), d, out + 2 * out_stride);
    hn::StoreU(hn::BitCast(d, hn::InterleaveUpper(dd, ab_high, ce_high)), d, out + 3 * out_stride);
#endif
}

HWY_INLINE void transpose_square(const double* HWY_RESTRICT in, std::size_t in_stride,
                                 double* HWY_RESTRICT out, std::size_t out_stride) {
#if HWY_TARGET == HWY_SCALAR
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) out[j * out_stride + i] = in[i * in_stride + j];
    }
#else
    const hn::FixedTag<double, 2> d;
    for (std::size_t i = 0; i < 4; i += 2) {
        for (std::size_t j = 0; j < 4; j += 2) {
            const auto a = hn::LoadU(d, in + i * in_stride + j);
            const auto b = hn::LoadU(d, in + (i + 1) * in_stride + j);
            hn::StoreU(hn::InterleaveLower(d, a, b), d, out + j * out_stride + i);
            hn::StoreU(hn::InterleaveUpper(d, a, b), d, out + (j + 1) * out_stride + i);
        }
    }
#endif
}

void factor_float(const LineBundle& b, const float* diffusivity, std::size_t stride, float h,
                  const LineFactors<float>& f) {
    factor<float>(b, diffusivity, stride, h, f);
}
void factor_double(const LineBundle& b, const double* diffusivity, std::size_t stride, double h,
                   const LineFactors<double>& f) {
    factor<double>(b, diffusivity, stride, h, f);
}
void solve_float(const LineBundle& b, const LineFactors<float>& f, float* rho, std::size_t stride,
                 const float* noise, float s, float* scratch, AfterSolve after) {
    solve<float>(b, f, rho, stride, noise, s, scratch, after);
}
void solve_double(const LineBundle& b, const LineFactors<double>& f, double* rho,
                  std::size_t stride, const float* noise, double s, double* scratch,
                  AfterSolve after) {
    solve<double>(b, f, rho, stride, noise, s, scratch, after);
}

template <class Real>
HWY_INLINE void transpose(const Real* in, std::size_t in_stride, int rows, int columns, Real* out,
                          std::size_t out_stride) {
    for (std::size_t y = 0; y < static_cast<std::size_t>(rows); y += 4) {
        for (std::size_t x = 0; x < static_cast<std::size_t>(columns); x += 4) {
            transpose_square(in + y * in_stride + x, in_stride, out + x * out_stride + y,
                             out_stride);
        }
    }
}
void transpose_float(const float* in, std::size_t in_stride, int rows, int columns, float* out,
                     std::size_t out_stride) {
    transpose(in, in_stride, rows, columns, out, out_stride);
}
void transpose_double(const double* in, std::size_t in_stride, int rows, int columns, double* out,
                      std::size_t out_stride) {
    transpose(in, in_stride, rows, columns, out, out_stride);
}

}  // namespace grainfield::simulate::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainfield::simulate {

HWY_EXPORT(factor_float);
HWY_EXPORT(factor_double);
HWY_EXPORT(solve_float);
HWY_EXPORT(solve_double);
HWY_EXPORT(transpose_float);
HWY_EXPORT(transpose_double);

namespace {

void transpose(const float* in, std::size_t in_stride, int rows, int columns, float* out,
               std::size_t out_stride) {
    HWY_DYNAMIC_DISPATCH(transpose_float)(in, in_stride, rows, columns, out, out_stride);
}
void transpose(const double* in, std::size_t in_stride, int rows, int columns, double* out,
               std::size_t out_stride) {
    HWY_DYNAMIC_DISPATCH(transpose_double)(in, in_stride, rows, columns, out, out_stride);
}

int rounded_up(int n) {
    return (n + 3) / 4 * 4;
}

}  // namespace

int warm_up(double a, double epsilon) {
    const double root = std::sqrt(1 + 4 * a);
    const double decay = (root - 1) / (root + 1);
    if (!(decay > 0)) return 1;
    return std::max(1, static_cast<int>(std::ceil(std::log(epsilon) / std::log(decay))));
}

template <>
void factor_lines(const LineBundle& bundle, const float* diffusivity, std::size_t stride, float h,
                  const LineFactors<float>& factors) {
    HWY_DYNAMIC_DISPATCH(factor_float)(bundle, diffusivity, stride, h, factors);
}
template <>
void factor_lines(const LineBundle& bundle, const double* diffusivity, std::size_t stride, double h,
                  const LineFactors<double>& factors) {
    HWY_DYNAMIC_DISPATCH(factor_double)(bundle, diffusivity, stride, h, factors);
}

template <>
void solve_lines(const LineBundle& bundle, const LineFactors<float>& factors, float* rho,
                 std::size_t stride, const float* noise, float s, float* scratch,
                 AfterSolve after) {
    HWY_DYNAMIC_DISPATCH(solve_float)(bundle, factors, rho, stride, noise, s, scratch, after);
}
template <>
void solve_lines(const LineBundle& bundle, const LineFactors<double>& factors, double* rho,
                 std::size_t stride, const float* noise, double s, double* scratch,
                 AfterSolve after) {
    HWY_DYNAMIC_DISPATCH(solve_double)(bundle, factors, rho, stride, noise, s, scratch, after);
}

template <class Real>
double squared_differences(const LineBundle& bundle, const Real* q, std::size_t stride) {
    double sum[line_lanes] = {};
    const auto cells = static_cast<std::size_t>(bundle.cells);
    for (std::size_t i = 0; i < cells; ++i) {
        const Real* here = q + i * stride;
        const Real* next = q + (i + 1 == cells ? 0 : i + 1) * stride;
        for (std::size_t l = 0; l < line_lanes; ++l) {
            const auto step = static_cast<double>(next[l] - here[l]);
            sum[l] += step * step;
        }
    }
    double total = 0;
    for (double lane : sum) total += lane;
    return total;
}
template double squared_differences(const LineBundle&, const float*, std::size_t);
template double squared_differences(const LineBundle&, const double*, std::size_t);

template <class Real>
void lanes_from_rows(const Real* in, std::size_t in_stride, int rows, int columns, Real* out) {
    const int whole = rows / 4 * 4;
    transpose(in, in_stride, whole, rounded_up(columns), out, line_lanes);
    for (int x = 0; x < columns && whole < line_lanes; ++x) {
        Real* to = out + static_cast<std::size_t>(x) * line_lanes;
        for (int y = whole; y < line_lanes; ++y) {
            to[y] = y < rows
                        ? in[static_cast<std::size_t>(y) * in_stride + static_cast<std::size_t>(x)]
                        : Real{0};
        }
    }
}
template void lanes_from_rows(const float*, std::size_t, int, int, float*);
template void lanes_from_rows(const double*, std::size_t, int, int, double*);

template <class Real>
void rows_from_lanes(const Real* in, int rows, int columns, Real* out, std::size_t out_stride) {
    const int whole = rows / 4 * 4;
    const int even = columns / 4 * 4;
    // Transposing back: "rows" of the kernel are the cells of the line.
    transpose(in, line_lanes, even, whole, out, out_stride);
    for (int y = 0; y < rows; ++y) {
        for (int x = y < whole ? even : 0; x < columns; ++x) {
            out[static_cast<std::size_t>(y) * out_stride + static_cast<std::size_t>(x)] =
                in[static_cast<std::size_t>(x) * line_lanes + static_cast<std::size_t>(y)];
        }
    }
}
template void rows_from_lanes(const float*, int, int, float*, std::size_t);
template void rows_from_lanes(const double*, int, int, double*, std::size_t);

}  // namespace grainfield::simulate
#endif
