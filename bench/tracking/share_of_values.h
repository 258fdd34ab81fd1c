#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace grainfield::bench {

/// The value that this share of them does not exceed; 0 of none.
inline double quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0;
    const auto place = values.begin() +
                       static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), place, values.end());
    return *place;
}

}  // namespace grainfield::bench
