#include "simulate/field/kernels/row_kernel.h"

// Plain loops that the compiler vectorises, once for each instruction set, chosen at run time.
// Sanitizers do not get along with the run-time choice.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define GRAINFIELD_ROW_KERNEL __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define GRAINFIELD_ROW_KERNEL
#endif

namespace grainfield::simulate {

namespace {

template <class Real>
[[gnu::always_inline]] inline void noise_row(const Real* __restrict rho, const RowNoise& noise,
                                             Real s, int nx, Real* __restrict z) {
    const float* __restrict x = noise.x;
    const float* __restrict below = noise.below;
    const float* __restrict above = noise.above;
    // In double each noise is widened first, so that what leaves one cell enters the next exactly.
    const auto kick = [&](int left, int i) __attribute__((always_inline)) {
        return (static_cast<Real>(x[i]) - static_cast<Real>(x[left])) +
               (static_cast<Real>(above[i]) - static_cast<Real>(below[i]));
    };
    z[0] = rho[0] + s * kick(nx - 1, 0);
    for (int i = 1; i < nx; ++i) z[i] = rho[i] + s * kick(i - 1, i);
}

template <class Real>
[[gnu::always_inline]] inline Real divergence(const RowStencil<Real>& z, const RowStencil<Real>& d,
                                              Real h_x, Real h_y, int left, int i, int right) {
    const Real along_x = (d.here[i] + d.here[right]) * (z.here[right] - z.here[i]) -
                         (d.here[left] + d.here[i]) * (z.here[i] - z.here[left]);
    const Real along_y = (d.here[i] + d.above[i]) * (z.above[i] - z.here[i]) -
                         (d.below[i] + d.here[i]) * (z.here[i] - z.below[i]);
    return h_x * along_x + h_y * along_y;
}

template <class Real>
[[gnu::always_inline]] inline void diffusion_row(const Real* base, const RowStencil<Real>& z,
                                                 const RowStencil<Real>& d, Real h_x, Real h_y,
                                                 int nx, Real* out) {
    const int last = nx - 1;
    out[0] = base[0] + divergence(z, d, h_x, h_y, last, 0, nx > 1 ? 1 : 0);
#pragma GCC ivdep
    for (int i = 1; i < last; ++i) {
        out[i] = base[i] + divergence(z, d, h_x, h_y, i - 1, i, i + 1);
    }
    if (last > 0) out[last] = base[last] + divergence(z, d, h_x, h_y, last - 1, last, 0);
}

template <class Real>
[[gnu::always_inline]] inline void reflect(const Real* z, const Real* rho, int nx, Real* out) {
#pragma GCC ivdep
    for (int i = 0; i < nx; ++i) out[i] = (z[i] + z[i]) - rho[i];
}

GRAINFIELD_ROW_KERNEL void noise_float(const float* rho, const RowNoise& noise, float s, int nx,
                                       float* z) {
    noise_row<float>(rho, noise, s, nx, z);
}
GRAINFIELD_ROW_KERNEL void noise_double(const double* rho, const RowNoise& noise, double s, int nx,
                                        double* z) {
    noise_row<double>(rho, noise, s, nx, z);
}
GRAINFIELD_ROW_KERNEL void diffusion_float(const float* base, const RowStencil<float>& z,
                                           const RowStencil<float>& d, float h_x, float h_y, int nx,
                                           float* out) {
    diffusion_row<float>(base, z, d, h_x, h_y, nx, out);
}
GRAINFIELD_ROW_KERNEL void diffusion_double(const double* base, const RowStencil<double>& z,
                                            const RowStencil<double>& d, double h_x, double h_y,
                                            int nx, double* out) {
    diffusion_row<double>(base, z, d, h_x, h_y, nx, out);
}
GRAINFIELD_ROW_KERNEL void reflect_float(const float* z, const float* rho, int nx, float* out) {
    reflect<float>(z, rho, nx, out);
}
GRAINFIELD_ROW_KERNEL void reflect_double(const double* z, const double* rho, int nx, double* out) {
    reflect<double>(z, rho, nx, out);
}

}  // namespace

template <>
void add_row_noise(const float* rho, const RowNoise& noise, float s, int nx, float* z) {
    noise_float(rho, noise, s, nx, z);
}
template <>
void add_row_noise(const double* rho, const RowNoise& noise, double s, int nx, double* z) {
    noise_double(rho, noise, s, nx, z);
}
template <>
void add_row_diffusion(const float* base, const RowStencil<float>& z, const RowStencil<float>& d,
                       float h_x, float h_y, int nx, float* out) {
    diffusion_float(base, z, d, h_x, h_y, nx, out);
}
template <>
void add_row_diffusion(const double* base, const RowStencil<double>& z, const RowStencil<double>& d,
                       double h_x, double h_y, int nx, double* out) {
    diffusion_double(base, z, d, h_x, h_y, nx, out);
}
template <>
void reflect_row(const float* z, const float* rho, int nx, float* out) {
    reflect_float(z, rho, nx, out);
}
template <>
void reflect_row(const double* z, const double* rho, int nx, double* out) {
    reflect_double(z, rho, nx, out);
}

}  // namespace grainfield::simulate
