#include "analysis/statistics/critical_result.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "analysis/statistics/blocks.h"
#include "analysis/statistics/critical_power.h"

namespace grainfield::analysis {
namespace {

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
    const char* doubt = fit.points > (has_constant ? 3 : 2)
                            ? ""
                            : "as many numbers as runs: they fit whatever it is";
    m.push_back({"power", "-", fit.power, fit.power_error, runs, doubt});
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
