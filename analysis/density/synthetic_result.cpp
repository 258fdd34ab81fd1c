#include "analysis/density/synthetic_result.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "analysis/density/synthetic_variance.h"
#include "analysis/recorded_options.h"
#include "analysis/spectra/fit_result.h"
#include "analysis/statistics/blocks.h"
#include "core/errors.h"

namespace grainfield::analysis {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();

std::vector<double> sides_of(const SyntheticOptions& options, double own) {
    if (!options.sides) return {own, 10 * own, infinite};
    for (const double side : *options.sides) {
        if (side > 0) continue;
        throw OptionError({.problem = "synthetic.sides holds something that is no side of a box",
                           .actual = fmt::format("{}", side),
                           .expected = "positive lengths in a, or inf",
                           .suggestion = {}});
    }
    return *options.sides;
}

std::optional<SpectrumModel::Line> line_of(const ObservableResult& fit) {
    const auto value = [&](const char* name) {
        const Measurement* m = fit.find_measurement(name);
        return m == nullptr ? std::optional<double>() : m->value;
    };
    const auto error = [&](const char* name) {
        const Measurement* m = fit.find_measurement(name);
        return m == nullptr ? undefined : m->error.value_or(undefined);
    };
    if (!value("s0") || !value("s1") || !value("alpha") || !value("k_fit")) return std::nullopt;
    return SpectrumModel::Line{*value("s0"),   *value("s1"), *value("alpha"),
                               error("s0"),    error("s1"),  value("s0_s1_correlation").value_or(0),
                               *value("k_fit")};
}

// Windows from one diameter to `last`, twelve a decade, and `last` itself.
std::vector<double> windows_up_to(double last) {
    std::vector<double> windows;
    for (int i = 0;; ++i) {
        const double window = std::pow(10.0, i / 12.0);
        if (window > last * (1 - 1e-9)) break;
        windows.push_back(window);
    }
    windows.push_back(last);
    return windows;
}

// None of a fitted exponent without one; a given exponent is exact.
std::optional<double> error_of_alpha(const ObservableResult& fit) {
    const OptionValue* exponent = fit.find_option("exponent");
    const bool is_fitted = exponent != nullptr && to_text(*exponent) == "free";
    const Measurement* alpha = fit.find_measurement("alpha");
    if (!is_fitted || alpha == nullptr) return 0;
    return alpha->error;
}

Measurement crossover(const ObservableResult& fit, const SpectrumModel::Line& line) {
    const Measurement* ratio = fit.find_measurement("s0_over_s1");
    if (ratio == nullptr) return missing("crossover_length", "a", "no S0/S1");
    if (!ratio->value) return missing("crossover_length", "a", ratio->reason);
    const auto length = [&](double r) {
        return 2 * std::numbers::pi * std::pow(r, -1 / line.alpha);
    };
    const double r = *ratio->value;
    const double spread = ratio->error.value_or(0);
    if (!(line.s1 > 0)) {
        return missing("crossover_length", "a", "S does not grow with k: S1 is not positive");
    }
    if (!(r > 0)) {
        return missing("crossover_length", "a",
                       r + spread > 0
                           ? fmt::format("S0/S1 is not positive: beyond {:.3g} within one "
                                         "standard error",
                                         length(r + spread))
                           : "S0/S1 is not positive");
    }
    Measurement m{"crossover_length", "a", length(r), std::nullopt, ratio->samples, ""};
    if (spread > 0 && spread < r) {
        const std::optional<double> bend = error_of_alpha(fit);
        if (!bend) {
            m.reason = "the fitted exponent has no error";
            return m;
        }
        m.error = length(r) / line.alpha * std::hypot(spread / r, std::log(r) / line.alpha * *bend);
    } else if (spread > 0) {
        m.reason = fmt::format("S0/S1 vanishes within its error: above {:.3g}", length(r + spread));
    } else {
        m.reason = "S0/S1 has no error";
    }
    return m;
}

// Below zero by more than rounding: where S0 is.
bool is_negative(const SyntheticVariance& value, double density, double window) {
    return value.variance < -1e-9 * density * window * window;
}

struct Table {
    Curve curve{"synthetic",
                "Number variance from S(k)",
                {{"l", "a", "Window side", {}},
                 {"variance", "-", "Number variance", {}},
                 {"err", "-", "Standard error", {}},
                 {"mean", "-", "Mean number", {}},
                 {"beyond", "-", "Of it from k above the measured ones, assumed", {}}},
                {}};

    void add(double side, double density, const std::vector<double>& windows,
             const std::vector<SyntheticVariance>& values) {
        const std::string name = std::isfinite(side) ? fmt::format("{:.6g}", side) : "inf";
        for (std::size_t i = 0; i < windows.size(); ++i) {
            if (is_negative(values[i], density, windows[i])) continue;  // said by add_side
            curve.columns[0].values.push_back(windows[i]);
            curve.columns[1].values.push_back(values[i].variance);
            // What lies beyond the measured wavevectors is assumed, not measured: wholly uncertain.
            curve.columns[2].values.push_back(std::hypot(values[i].error, values[i].beyond));
            curve.columns[3].values.push_back(density * windows[i] * windows[i]);
            curve.columns[4].values.push_back(values[i].beyond);
            curve.text_columns["side"].push_back(name);
        }
    }
};

// One box into the table, or why there is nothing.
std::string add_side(Table& table, const SpectrumModel& model, const SyntheticInput& input,
                     double side, const SyntheticOptions& options) {
    if (!model.has_fit() && side > input.side * (1 + 1e-9)) {
        return "needs S(k) below the measured wavevectors, which only a fit gives: " +
               why_no_fit(input.fit);
    }
    if (model.k_min() > 1.5 * 2 * std::numbers::pi / input.side) {
        return fmt::format(
            "S(k) at the lowest wavevectors, below {:.3g}/a, has no error (the run is shorter than "
            "their time) and there is no fit",
            model.k_min());
    }
    const std::vector<double> windows = windows_up_to(std::isfinite(side) ? side : options.largest);
    try {
        const std::vector<SyntheticVariance> values =
            std::isfinite(side) ? synthetic_variance(model, input.density, side, windows)
                                : synthetic_variance(model, input.density, windows);
        table.add(side, input.density, windows, values);
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (!is_negative(values[i], input.density, windows[i])) continue;
            return fmt::format("no variance from {:.3g} a on: S0 is below zero", windows[i]);
        }
    } catch (const OptionError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

OptionTable describe(SyntheticOptions& options) {
    OptionTable table("synthetic");
    table.numbers("sides", options.sides, "a", {.minimum = 1e-9, .may_be_infinite = true},
                  "sides of the boxes, as 100,1000,inf; auto: the measured one, ten times it, inf");
    table.choice("spectrum", options.spectrum,
                 {{"measured", SpectrumSource::measured}, {"fit", SpectrumSource::fit}},
                 "S(k) as measured above the fit, or the fit continued to S = 1");
    table.number("largest-window", options.largest, "a", {1, 1e6},
                 "largest window in an infinite box");
    return table;
}

SyntheticInput synthetic_input(const StructureFactor& sk, const ObservableResult& fit) {
    SyntheticInput input;
    input.fit = fit;
    const double area = sk.box().area();
    input.side = std::sqrt(area);
    input.density = sk.particles_mean() / area;
    if (!sk.allows(StructureFactor::Estimator::raw) || !(input.density > 0)) {
        input.reason = "no S(k): no particles or no wavevectors";
        return input;
    }
    if (!sk.is_periodic() && !sk.allows(StructureFactor::Estimator::connected)) {
        input.reason = "one frame: S(k) has the walls in it";
        return input;
    }
    input.spectrum = fitted_spectrum(sk, recorded_modes(fit));
    return input;
}

ObservableResult synthetic_result(const SyntheticInput& input, const SyntheticOptions& options) {
    ObservableResult result;
    result.name = "synthetic";
    SyntheticOptions copy = options;
    result.options = recorded(describe(copy));
    const std::vector<double> sides = sides_of(options, input.side);
    const std::optional<SpectrumModel::Line> line = line_of(input.fit);
    result.reason = input.reason;
    if (result.reason.empty() && input.spectrum.k.empty()) result.reason = "no S(k)";
    if (result.reason.empty() && !line && options.spectrum == SpectrumSource::fit) {
        result.reason = why_no_fit(input.fit);
    }
    if (!result.reason.empty()) return result;

    const auto tail = input.is_field ? SpectrumModel::Tail::constant : SpectrumModel::Tail::one;
    const SpectrumModel model = options.spectrum == SpectrumSource::fit
                                    ? SpectrumModel::of_fit(*line, tail)
                                    : SpectrumModel::of_measured(input.spectrum, line, tail);
    result.measurements.push_back(line ? crossover(input.fit, *line)
                                       : missing("crossover_length", "a", why_no_fit(input.fit)));
    Table table;
    for (const double side : sides) {
        const std::string why = add_side(table, model, input, side, options);
        if (why.empty()) continue;
        result.measurements.push_back(
            missing(std::isfinite(side) ? fmt::format("box_{:.6g}", side) : "box_inf", "a", why));
    }
    if (!table.curve.columns[0].values.empty()) result.curves.push_back(std::move(table.curve));
    return result;
}

}  // namespace grainfield::analysis
