#include "analysis/order/histogram_modes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace grainfield::analysis {
namespace {

// The histogram smoothed by a Gaussian with reflection at 0 and 1, as a function of the position.
class SmoothedHistogram {
 public:
    SmoothedHistogram(std::span<const double> counts, double share, double sigma)
        : counts_(counts), share_(share), sigma_(sigma) {}

    // y, y', y'' and the variance of y' from counting.
    struct Point {
        double value = 0, slope = 0, bend = 0, slope_variance = 0;
    };
    Point at(double x) const {
        Point point;
        const auto bins = static_cast<double>(counts_.size());
        for (std::size_t j = 0; j < counts_.size(); ++j) {
            const double centre = (static_cast<double>(j) + 0.5) / bins;
            double g = 0;
            double slope = 0;
            double bend = 0;
            for (const double image : {centre, -centre, 2 - centre}) {
                const double u = (x - image) / sigma_;
                if (std::abs(u) > 8) continue;
                const double e = std::exp(-0.5 * u * u);
                g += e;
                slope -= u / sigma_ * e;
                bend += (u * u - 1) / (sigma_ * sigma_) * e;
            }
            point.value += counts_[j] * g;
            point.slope += counts_[j] * slope;
            point.bend += counts_[j] * bend;
            point.slope_variance += counts_[j] / share_ * slope * slope;
        }
        return point;
    }

    // Counts per bin at the centres.
    std::vector<double> values() const {
        const auto bins = static_cast<double>(counts_.size());
        const double total = std::sqrt(2 * std::numbers::pi) * sigma_ * bins;
        std::vector<double> y;
        for (std::size_t i = 0; i < counts_.size(); ++i) {
            y.push_back(at((static_cast<double>(i) + 0.5) / bins).value / total);
        }
        return y;
    }

    // The zero of y' within a bin around the centre of `bin`, by bisection; `sign` +1 for a
    // maximum, -1 for a minimum. Without a change of sign the extremum is at the edge.
    double extremum(std::size_t bin, double sign) const {
        const auto bins = static_cast<double>(counts_.size());
        double low = std::max(0.0, (static_cast<double>(bin) - 0.5) / bins);
        double high = std::min(1.0, (static_cast<double>(bin) + 1.5) / bins);
        for (int step = 0; step < 50; ++step) {
            const double middle = 0.5 * (low + high);
            (sign * at(middle).slope > 0 ? low : high) = middle;
        }
        return 0.5 * (low + high);
    }

    std::optional<double> error(double x, double largest) const {
        if (x < 1e-9 || x > 1 - 1e-9) return std::nullopt;  // held there by the reflection
        const Point point = at(x);
        const double error = std::sqrt(point.slope_variance) / std::abs(point.bend);
        return error > 0 && error < largest ? std::optional<double>(error) : std::nullopt;
    }

 private:
    std::span<const double> counts_;
    double share_;
    double sigma_;
};

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

HistogramModes find_modes(std::span<const double> counts, double share, double smoothing) {
    HistogramModes modes;
    if (counts.size() < 8) {
        modes.reason = "too few bins to look for modes";
        return modes;
    }
    const auto bins = static_cast<double>(counts.size());
    const double sigma = smoothing * bins;
    const SmoothedHistogram curve(counts, share, smoothing);
    const std::vector<double> y = curve.values();
    // Smoothing averages about 2 sqrt(pi) sigma bins: the standard error of a smoothed count.
    const double averaged = std::max(1.0, 2 * std::sqrt(std::numbers::pi) * sigma);
    const auto error = [&](double count) {
        return std::sqrt(std::max(count, 1.0) / (share * averaged));
    };

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
            const auto top = std::max_element(tops.begin(), tops.end(),
                                              [&](auto p, auto q) { return y[p] < y[q]; });
            modes.low_mode = curve.extremum(*top, 1);
            modes.low_mode_error = curve.error(*modes.low_mode, 0.25);
        }
        return modes;
    }
    modes.low_mode = curve.extremum(left, 1);
    modes.high_mode = curve.extremum(right, 1);
    modes.minimum = curve.extremum(bottom, -1);
    const double below = *modes.minimum - *modes.low_mode;
    const double above = *modes.high_mode - *modes.minimum;
    modes.low_mode_error = curve.error(*modes.low_mode, 0.5 * below);
    modes.high_mode_error = curve.error(*modes.high_mode, 0.5 * above);
    modes.minimum_error = curve.error(*modes.minimum, 0.5 * std::min(below, above));
    return modes;
}

}  // namespace grainfield::analysis
