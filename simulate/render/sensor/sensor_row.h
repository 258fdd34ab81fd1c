#pragma once

#include <cstdint>

namespace grainfield::simulate {

/// What a row of pixels has in common.
struct SensorTerms {
    float electrons;   ///< q: at exposure 1 [e-]
    float read_noise;  ///< σ_r [e-]
    float gain;        ///< K [DN/e-]
    float offset;      ///< [DN]
    float full_well;   ///< [e-]
    float full_scale;  ///< 2^bits − 1 [DN]
};

/// Expected photo-electrons of a row, q E (1 + p) + 0: `response` may be null (1).
void expected_electrons(const float* exposure, const float* response, int count, float q,
                        float* mean);

/// mean → mean + noise: the Cornish–Fisher form of Camera's docstring, from normal numbers z.
void add_noise(const float* z, int count, float read_noise, float* electrons);

/// Electrons to counts: `dark` [e-] may be null (0).
void quantise(const float* electrons, const float* dark, int count, const SensorTerms& terms,
              float* counts);

}  // namespace grainfield::simulate
