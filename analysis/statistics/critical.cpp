#include "analysis/statistics/critical.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace grainfield::analysis {
namespace {

CriticalFit refused(std::string reason) {
    CriticalFit fit;
    fit.reason = std::move(reason);
    return fit;
}

// Where (a + b x)² = σ²(x): a quadratic in x.
void add_interval(CriticalFit& fit) {
    const double b2 = fit.slope * fit.slope - fit.slope_error * fit.slope_error;
    const double ab = fit.intercept * fit.slope - fit.covariance;
    const double a2 = fit.intercept * fit.intercept - fit.intercept_error * fit.intercept_error;
    const double root = ab * ab - a2 * b2;
    if (!(b2 > 0) || !(root >= 0)) {
        // Two errors of the slope are asked for. They fall as the root of the length of the runs,
        // and as the range of the control parameter grows.
        const double ratio = 2 * fit.slope_error / std::abs(fit.slope);
        fit.reason = ratio < 100
                         ? fmt::format(
                               "the slope vanishes within its error: no interval; runs {:.0f} "
                               "times as long, "
                               "or {:.1f} times the range of the control parameter, would give one",
                               std::ceil(ratio * ratio - 1e-9), ratio)
                         : "S0/S1 is the same at all values of the control parameter: no interval";
        return;
    }
    fit.interval = Interval{(-ab - std::sqrt(root)) / b2, (-ab + std::sqrt(root)) / b2};
}

}  // namespace

double CriticalFit::value_error(double x) const {
    const double variance =
        intercept_error * intercept_error + 2 * x * covariance + x * x * slope_error * slope_error;
    return std::sqrt(std::max(0.0, variance));
}

CriticalFit fit_critical(std::span<const CriticalPoint> points, CriticalLine line) {
    if (line == CriticalLine::power || line == CriticalLine::power_and_constant) {
        return refused("a power is no line: fit_critical_power");
    }
    const bool free = line == CriticalLine::free;
    const std::size_t least = free ? 3 : 2;
    double sw = 0, sx = 0, sy = 0;
    CriticalFit fit;
    for (const CriticalPoint& p : points) {
        if (!std::isfinite(p.x) || !std::isfinite(p.ratio) || !(p.error > 0)) {
            return refused(fmt::format("the point at {} has no value or no error", p.x));
        }
        const double w = 1 / (p.error * p.error);
        sw += w;
        sx += w * p.x;
        sy += w * p.ratio;
        ++fit.points;
    }
    if (points.size() < least) {
        return refused(fmt::format("{} run{} with S0/S1 and its error, {} are needed",
                                   points.size(), points.size() == 1 ? "" : "s", least));
    }
    const double mx = free ? sx / sw : 0;
    const double my = free ? sy / sw : 0;
    double sxx = 0, sxy = 0;
    for (const CriticalPoint& p : points) {
        const double w = 1 / (p.error * p.error);
        sxx += w * (p.x - mx) * (p.x - mx);
        sxy += w * (p.x - mx) * (p.ratio - my);
    }
    if (!(sxx > 0)) return refused("all runs have the same value of the control parameter");
    fit.slope = sxy / sxx;
    fit.slope_error = 1 / std::sqrt(sxx);
    if (free) {
        fit.intercept = my - fit.slope * mx;
        fit.intercept_error = std::sqrt(1 / sw + mx * mx / sxx);
        fit.covariance = -mx / sxx;
    }
    for (const CriticalPoint& p : points) {
        const double d = (p.ratio - fit.value(p.x)) / p.error;
        fit.chi2 += d * d;
    }
    if (!free) {
        fit.reason = "the line is held to zero at zero";
        return fit;
    }
    if (fit.slope != 0) fit.critical = -fit.intercept / fit.slope;
    add_interval(fit);
    return fit;
}

}  // namespace grainfield::analysis
