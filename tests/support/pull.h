#pragma once

#include <cmath>

namespace grainfield::testing {

/// Mean and width of pulls, (value − truth)/error: 0 and 1 where errors are honest.
struct Pull {
    double sum = 0, squares = 0, count = 0;
    void add(double x) {
        sum += x;
        squares += x * x;
        count += 1;
    }
    double mean() const { return sum / count; }
    double width() const { return std::sqrt(squares / count - mean() * mean()); }
};

}  // namespace grainfield::testing
