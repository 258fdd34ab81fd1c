#include "analysis/statistics/critical.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "analysis/statistics/blocks.h"
#include "analysis/statistics/critical_power.h"

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

Curve empty_curve(std::string name, std::string title, const std::string& parameter) {
    return {std::move(name),
            std::move(title),
            {{"x", "-", parameter, {}},
             {"s0_over_s1", "-", "S0/S1", {}},
             {"err", "-", "Standard error", {}}},
            {}};
}

void add_row(Curve& curve, double x, double ratio, double error) {
    curve.columns[0].values.push_back(x);
    curve.columns[1].values.push_back(ratio);
    curve.columns[2].values.push_back(error);
}

void add_chi2(ObservableResult& result, double chi2, int points, int parameters, const char* what) {
    const int free = points - parameters;
    if (free <= 0) return;
    result.measurements.push_back({"chi2_per_dof", "-", chi2 / free, std::sqrt(2.0 / free),
                                   static_cast<double>(free),
                                   fmt::format("about one if {} describes the points", what)});
}

std::pair<double, double> extent(std::span<const CriticalPoint> points) {
    const auto [low, high] = std::ranges::minmax(points, {}, &CriticalPoint::x);
    return {low.x, high.x};
}

// Where the line is zero, and why it has no interval or lies where no run is.
Measurement critical_value(const CriticalFit& fit, std::span<const CriticalPoint> points) {
    const auto runs = static_cast<double>(fit.points);
    if (!fit.critical) return missing("critical_value", "-", fit.reason);
    Measurement value{"critical_value", "-", fit.critical, std::nullopt, runs, fit.reason};
    if (fit.interval) value.error = 0.5 * (fit.interval->high - fit.interval->low);
    const auto [low, high] = extent(points);
    if (*fit.critical < low || *fit.critical > high) {
        value.reason += fmt::format("{}outside the runs, which are from {:.4g} to {:.4g}",
                                    value.reason.empty() ? "" : "; ", low, high);
    }
    return value;
}

void add_line(ObservableResult& result, std::span<const CriticalPoint> points, CriticalLine line,
              const std::string& parameter) {
    const CriticalFit fit = fit_critical(points, line);
    if (fit.points == 0) {
        result.reason = fit.reason;
        return;
    }
    const bool is_free = line == CriticalLine::free;
    const auto runs = static_cast<double>(fit.points);
    auto& m = result.measurements;
    m.push_back(critical_value(fit, points));
    if (fit.interval) {
        const char* meaning = "end of the 68 % interval";
        m.push_back({"critical_low", "-", fit.interval->low, std::nullopt, runs, meaning});
        m.push_back({"critical_high", "-", fit.interval->high, std::nullopt, runs, meaning});
    }
    m.push_back({"slope", "-", fit.slope, fit.slope_error, runs, ""});
    if (is_free) m.push_back({"intercept", "-", fit.intercept, fit.intercept_error, runs, ""});
    add_chi2(result, fit.chi2, fit.points, is_free ? 2 : 1, "the line");
    Curve curve = empty_curve("critical_line", "Weighted line", parameter);
    const auto [low, high] = extent(points);
    const double zero = is_free ? fit.critical.value_or(low) : 0;
    const double first = std::min(low, zero);
    const double last = std::max(high, zero);
    for (int i = 0; i <= 40; ++i) {
        const double x = first + (last - first) * i / 40.0;
        add_row(curve, x, fit.value(x), fit.value_error(x));
    }
    result.curves.push_back(curve);
}

void add_power(ObservableResult& result, std::span<const CriticalPoint> points, CriticalLine line,
               const std::string& parameter) {
    const bool has_constant = line == CriticalLine::power_and_constant;
    const CriticalPower fit =
        fit_critical_power(points, has_constant ? PowerConstant::free : PowerConstant::none);
    if (!fit.ok()) {
        result.reason = fit.reason;
        return;
    }
    const auto runs = static_cast<double>(fit.points);
    auto& m = result.measurements;
    m.push_back(missing("critical_value", "-",
                        has_constant ? "a power and a constant: the constant is the limit at zero"
                                     : "a power vanishes at zero"));
    m.push_back({"power", "-", fit.power, fit.power_error, runs, ""});
    m.push_back({"factor", "-", fit.factor, fit.factor_error, runs, ""});
    if (has_constant) {
        m.push_back({"constant", "-", fit.constant, fit.constant_error, runs, ""});
    }
    add_chi2(result, fit.chi2, fit.points, has_constant ? 3 : 2, "the power");
    Curve curve = empty_curve("critical_line", "Weighted power", parameter);
    const double last = extent(points).second;
    for (int i = 0; i <= 40; ++i) {
        const double share = i / 40.0;
        const double x = last * share * share;  // dense near zero, where a small power is steep
        add_row(curve, x, fit.value(x), fit.value_error(x));
    }
    result.curves.push_back(curve);
}

}  // namespace

double CriticalFit::value_error(double x) const {
    const double variance =
        intercept_error * intercept_error + 2 * x * covariance + x * x * slope_error * slope_error;
    return std::sqrt(std::max(0.0, variance));
}

CriticalFit fit_critical(std::span<const CriticalPoint> points, CriticalLine line) {
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

ObservableResult critical_result(std::span<const CriticalPoint> points, CriticalLine line,
                                 const std::string& parameter,
                                 const std::optional<Measurement>& alpha) {
    ObservableResult result;
    result.name = "critical";
    Curve data = empty_curve("critical", "S0/S1 against " + parameter, parameter);
    for (const CriticalPoint& p : points) add_row(data, p.x, p.ratio, p.error);
    if (!points.empty()) result.curves.push_back(data);
    const bool is_power = line == CriticalLine::power || line == CriticalLine::power_and_constant;
    if (is_power) {
        add_power(result, points, line, parameter);
    } else {
        add_line(result, points, line, parameter);
    }
    if (alpha && result.reason.empty()) result.measurements.push_back(*alpha);
    return result;
}

ObservableTitles critical_titles() {
    return {"critical",
            "Critical point",
            {{"critical_value", "Critical value of the control parameter"},
             {"critical_low", "Critical value, lower end"},
             {"critical_high", "Critical value, upper end"},
             {"slope", "Slope of S₀/S₁"},
             {"intercept", "Intercept of S₀/S₁"},
             {"power", "Power of the control parameter"},
             {"factor", "Factor of the power"},
             {"constant", "Limit of S₀/S₁ at zero"},
             {"chi2_per_dof", "χ² per degree of freedom"},
             {"alpha", "Exponent α"}}};
}

}  // namespace grainfield::analysis
