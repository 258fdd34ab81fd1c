#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "tracking/model/overlap_rule.h"

namespace grainfield::tracking {

/// C(r), by how much the image of a sphere is darker than its profile: a mirror rim, a blur of
/// another shape, less or more light from the core.
///
/// Linear between the values at r = 0, spacing, 2 spacing …; zero beyond the last. Learned once
/// (calibrate/learned_profile.h), then frozen. Discs with a correction pass Π_j (1 − P_j − C_j)
/// instead of Π_j (1 − P_j).
struct RadialCorrection {
    double spacing = 0;        ///< [px]
    std::vector<float> value;  ///< [contrast]; empty: zero everywhere

    bool is_zero() const { return value.empty(); }
    float operator()(float r) const {
        const float place = r / static_cast<float>(spacing);
        const auto i = static_cast<std::size_t>(place);
        if (i + 1 >= value.size()) return 0;
        return value[i] + (place - static_cast<float>(i)) * (value[i + 1] - value[i]);
    }
    /// The largest of |C| [contrast].
    double largest() const {
        float most = 0;
        for (const float v : value) most = std::max(most, std::abs(v));
        return static_cast<double>(most);
    }

    /// Adds Π_j (1 − P_j − C_j) − Π_j (1 − P_j) to the rows of a band.
    void add_to(const DiscBand& discs, Image& darkness) const;
};

}  // namespace grainfield::tracking
