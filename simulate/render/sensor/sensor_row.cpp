#include "simulate/render/sensor/sensor_row.h"

#include <algorithm>
#include <cmath>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define GRAINFIELD_SENSOR_KERNEL __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define GRAINFIELD_SENSOR_KERNEL
#endif

namespace grainfield::simulate {

GRAINFIELD_SENSOR_KERNEL void expected_electrons(const float* __restrict exposure,
                                                 const float* __restrict response, int count,
                                                 float q, float* __restrict mean) {
    if (response == nullptr) {
        for (int i = 0; i < count; ++i) mean[i] = q * exposure[i];
    } else {
        for (int i = 0; i < count; ++i) mean[i] = q * exposure[i] * response[i];
    }
}

GRAINFIELD_SENSOR_KERNEL void add_noise(const float* __restrict z, int count, float read_noise,
                                        float* __restrict electrons) {
    const float read2 = read_noise * read_noise;
    for (int i = 0; i < count; ++i) {
        const float mean = std::max(electrons[i], 0.0F);
        const float s2 = mean + read2;
        const float skew = mean / (6.0F * s2 + 1e-20F) * (z[i] * z[i] - 1.0F);
        electrons[i] = mean + std::sqrt(s2) * z[i] + skew;
    }
}

GRAINFIELD_SENSOR_KERNEL void quantise(const float* __restrict electrons,
                                       const float* __restrict dark, int count,
                                       const SensorTerms& terms, float* __restrict counts) {
    const float gain = terms.gain;
    const float offset = terms.offset;
    const float well = terms.full_well;
    const float top = terms.full_scale;
    const auto convert = [&](float e) __attribute__((always_inline)) {
        const float dn = gain * std::min(e, well) + offset;
        // Clamped first, so that rounding by conversion cannot overflow.
        const float raised = std::min(std::max(dn, 0.0F), top) + 0.5F;
        return static_cast<float>(static_cast<int>(raised));
    };
    if (dark == nullptr) {
        for (int i = 0; i < count; ++i) counts[i] = convert(electrons[i]);
    } else {
        for (int i = 0; i < count; ++i) counts[i] = convert(electrons[i] + dark[i]);
    }
}

}  // namespace grainfield::simulate
