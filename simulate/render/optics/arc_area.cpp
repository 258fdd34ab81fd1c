#include "simulate/render/optics/arc_area.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define GRAINFIELD_ARC_KERNEL __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define GRAINFIELD_ARC_KERNEL
#endif

namespace grainfield::simulate {

GRAINFIELD_ARC_KERNEL void arc_areas(const double* __restrict t, std::size_t count, double radius,
                                     double* __restrict h, double* __restrict area) {
    const double r2 = radius * radius;
    for (std::size_t i = 0; i < count; ++i) {
        // asin x = π/2 − 2 asin √((1 − x)/2) where x > 1/2, so that z ≤ 1/4.
        const double x = std::min(std::abs(t[i]) / radius, 1.0);
        const bool is_small = x <= 0.5;
        const double z = is_small ? x * x : 0.5 * (1 - x);
        const double root = std::sqrt(z);
        // (asin √z/√z − 1)/z at twelve Chebyshev nodes of [0, 1/4].
        double p = 0.028169218060881414;
        p = p * z - 0.010749050339697808;
        p = p * z + 0.01603551434914882;
        p = p * z + 0.0078029494773533175;
        p = p * z + 0.011875494382636922;
        p = p * z + 0.013929652902326633;
        p = p * z + 0.017355259955786323;
        p = p * z + 0.02237204763174451;
        p = p * z + 0.03038194736709848;
        p = p * z + 0.044642857103423646;
        p = p * z + 0.07500000000020764;
        p = p * z + 0.1666666666666665;
        const double low = root + root * z * p;
        const double angle = is_small ? low : 0.5 * std::numbers::pi - 2 * low;
        const double half = std::sqrt(std::max(r2 - t[i] * t[i], 0.0));
        h[i] = half;
        area[i] = 0.5 * (t[i] * half + std::copysign(r2 * angle, t[i]));
    }
}

}  // namespace grainfield::simulate
