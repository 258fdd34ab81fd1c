#include "analysis/motion/pair_sums.h"

#include <cstring>

namespace grainfield::analysis {
namespace {

// Four doubles; GCC and Clang lower it to whatever the instruction set of the function offers.
using Lanes = double __attribute__((vector_size(32)));

[[gnu::always_inline]] inline void load(Lanes& to, const double* from) {
    std::memcpy(&to, from, sizeof to);
}

[[gnu::always_inline]] inline double plain(const double* x, const double* y, std::size_t first,
                                           std::size_t last, std::size_t lag) {
    Lanes sum = {0, 0, 0, 0};
    std::size_t i = first;
    for (; i + 4 <= last; i += 4) {
        Lanes x0, x1, y0, y1;
        load(x0, x + i);
        load(x1, x + i + lag);
        load(y0, y + i);
        load(y1, y + i + lag);
        const Lanes dx = x1 - x0;
        const Lanes dy = y1 - y0;
        sum += dx * dx + dy * dy;
    }
    double total = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    for (; i < last; ++i) {
        const double dx = x[i + lag] - x[i];
        const double dy = y[i + lag] - y[i];
        total += dx * dx + dy * dy;
    }
    return total;
}

[[gnu::always_inline]] inline double masked(const double* x, const double* y, const double* w,
                                            std::size_t first, std::size_t last, std::size_t lag,
                                            double& count) {
    Lanes sum = {0, 0, 0, 0};
    Lanes pairs = {0, 0, 0, 0};
    std::size_t i = first;
    for (; i + 4 <= last; i += 4) {
        Lanes x0, x1, y0, y1, w0, w1;
        load(x0, x + i);
        load(x1, x + i + lag);
        load(y0, y + i);
        load(y1, y + i + lag);
        load(w0, w + i);
        load(w1, w + i + lag);
        const Lanes dx = x1 - x0;
        const Lanes dy = y1 - y0;
        const Lanes both = w0 * w1;
        sum += (dx * dx + dy * dy) * both;
        pairs += both;
    }
    double total = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    double number = (pairs[0] + pairs[1]) + (pairs[2] + pairs[3]);
    for (; i < last; ++i) {
        const double dx = x[i + lag] - x[i];
        const double dy = y[i + lag] - y[i];
        total += (dx * dx + dy * dy) * (w[i] * w[i + lag]);
        number += w[i] * w[i + lag];
    }
    count += number;
    return total;
}

#if defined(__x86_64__) && defined(__GNUC__)
[[gnu::target("avx2")]] double plain_avx2(const double* x, const double* y, std::size_t first,
                                          std::size_t last, std::size_t lag) {
    return plain(x, y, first, last, lag);
}
[[gnu::target("avx2")]] double masked_avx2(const double* x, const double* y, const double* w,
                                           std::size_t first, std::size_t last, std::size_t lag,
                                           double& count) {
    return masked(x, y, w, first, last, lag, count);
}
const bool has_avx2 = __builtin_cpu_supports("avx2") != 0;
#endif

}  // namespace

double sum_squared_steps(const double* x, const double* y, std::size_t first, std::size_t last,
                         std::size_t lag) {
#if defined(__x86_64__) && defined(__GNUC__)
    if (has_avx2) return plain_avx2(x, y, first, last, lag);
#endif
    return plain(x, y, first, last, lag);
}

double sum_squared_steps_masked(const double* x, const double* y, const double* w,
                                std::size_t first, std::size_t last, std::size_t lag,
                                double& count) {
#if defined(__x86_64__) && defined(__GNUC__)
    if (has_avx2) return masked_avx2(x, y, w, first, last, lag, count);
#endif
    return masked(x, y, w, first, last, lag, count);
}

}  // namespace grainfield::analysis
