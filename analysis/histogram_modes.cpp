#include "analysis/histogram_modes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace grainfield::analysis {
namespace {

std::vector<double> smoothed(std::span<const double> counts, double sigma_bins) {
    const auto n = static_cast<std::ptrdiff_t>(counts.size());
    const auto reach = static_cast<std::ptrdiff_t>(std::ceil(4 * sigma_bins));
    std::vector<double> result(counts.size(), 0.0);
    double total = 0;
    for (std::ptrdiff_t j = -reach; j <= reach; ++j) {
        const double u = static_cast<double>(j) / sigma_bins;
        total += std::exp(-0.5 * u * u);
    }
    for (std::ptrdiff_t i = 0; i < n; ++i) {
        for (std::ptrdiff_t j = -reach; j <= reach; ++j) {
            const double u = static_cast<double>(j) / sigma_bins;
            std::ptrdiff_t at = i + j;
            if (at < 0) at = -1 - at;
            if (at >= n) at = 2 * n - 1 - at;
            at = std::clamp<std::ptrdiff_t>(at, 0, n - 1);
            result[static_cast<std::size_t>(i)] +=
                counts[static_cast<std::size_t>(at)] * std::exp(-0.5 * u * u) / total;
        }
    }
    return result;
}

std::vector<std::size_t> peaks(const std::vector<double>& y) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < y.size(); ++i) {
        const bool above_left = i == 0 || y[i] > y[i - 1];
        const bool above_right = i + 1 == y.size() || y[i] >= y[i + 1];
        if (above_left && above_right && y[i] > 0) found.push_back(i);
    }
    return found;
}

}  // namespace

HistogramModes find_modes(std::span<const double> counts, double smoothing) {
    HistogramModes modes;
    if (counts.size() < 8) {
        modes.reason = "too few bins to look for modes";
        return modes;
    }
    const auto bins = static_cast<double>(counts.size());
    const double sigma = smoothing * bins;
    const std::vector<double> y = smoothed(counts, sigma);
    // Smoothing averages about 2 sqrt(pi) sigma bins: the standard error of a smoothed count.
    const double averaged = std::max(1.0, 2 * std::sqrt(std::numbers::pi) * sigma);
    const auto error = [&](double count) { return std::sqrt(std::max(count, 1.0) / averaged); };
    const auto centre = [&](std::size_t bin) { return (static_cast<double>(bin) + 0.5) / bins; };

    const std::vector<std::size_t> tops = peaks(y);
    double best = 0;
    std::size_t left = 0;
    std::size_t right = 0;
    std::size_t bottom = 0;
    for (std::size_t a = 0; a < tops.size(); ++a) {
        for (std::size_t b = a + 1; b < tops.size(); ++b) {
            const auto low = std::min_element(y.begin() + static_cast<std::ptrdiff_t>(tops[a]),
                                              y.begin() + static_cast<std::ptrdiff_t>(tops[b]));
            const double lower_peak = std::min(y[tops[a]], y[tops[b]]);
            const double depth = lower_peak - *low;
            if (depth > 6 * std::hypot(error(*low), error(lower_peak)) &&
                depth > 0.1 * lower_peak && depth > best) {
                best = depth;
                left = tops[a];
                right = tops[b];
                bottom = static_cast<std::size_t>(low - y.begin());
            }
        }
    }
    if (best <= 0) {
        modes.reason = "the distribution has one mode within counting noise";
        if (!tops.empty()) {
            modes.low_mode = centre(*std::max_element(tops.begin(), tops.end(),
                                                      [&](auto p, auto q) { return y[p] < y[q]; }));
        }
        return modes;
    }
    modes.low_mode = centre(left);
    modes.high_mode = centre(right);
    modes.minimum = centre(bottom);
    std::size_t from = bottom;
    std::size_t to = bottom;
    const double indistinct = y[bottom] + error(y[bottom]);
    while (from > left && y[from - 1] <= indistinct) --from;
    while (to < right && y[to + 1] <= indistinct) ++to;
    modes.minimum_error = 0.5 * (static_cast<double>(to - from) + 1) / bins;
    return modes;
}

}  // namespace grainfield::analysis
