#pragma once

#include <cstddef>

namespace grainfield::analysis {

/// Σ_{i = first}^{last − 1} (x[i + lag] − x[i])² + (y[i + lag] − y[i])², in four interleaved
/// partial sums, so that the result does not depend on the instruction set.
double sum_squared_steps(const double* x, const double* y, std::size_t first, std::size_t last,
                         std::size_t lag);

/// The same over the pairs with w[i] = w[i + lag] = 1 (0: missing; x and y must then be finite);
/// adds the number of these pairs to `count`.
double sum_squared_steps_masked(const double* x, const double* y, const double* w,
                                std::size_t first, std::size_t last, std::size_t lag,
                                double& count);

}  // namespace grainfield::analysis
