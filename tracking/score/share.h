#pragma once

#include <limits>

namespace grainfield::tracking {

/// part/whole; NaN, which stands for "no value", where the whole is zero: of nothing there is no
/// share, neither all nor none.
template <class Number>
double share(Number part, Number whole) {
    return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole)
                     : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace grainfield::tracking
