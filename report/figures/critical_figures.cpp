#include "report/figures/critical_figures.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/run_identity.h"
#include "report/figures/figure_source.h"
#include "report/figures/panels.h"
#include "report/page/cards.h"
#include "report/text.h"

namespace grainfield::report {

namespace {

const CurveColumns points{"critical", "critical", "x", "s0_over_s1", "err"};
const CurveColumns line{"critical", "critical_line", "x", "s0_over_s1", "err"};
constexpr double least_known = 0.25;  // error of the critical value over itself

void add_sentence(std::string& note, const std::string& sentence) {
    note += (note.empty() ? "" : " ") + sentence;
}

Figure figure_of(const std::vector<std::string>& labels, std::string name, std::string title,
                 Axis x) {
    return empty_figure(labels, std::move(name), std::move(title), std::move(x),
                        {"s0_over_s1", "S₀/S₁", "", Scale::linear, true});
}

void add_kinds(Figure& figure, const Runs& runs) {
    // Not joined: the line is that of the fit.
    add_kind(figure, runs, {.label = "S₀/S₁", .mark = Mark::line, .is_joined = false}, points);
    add_kind(figure, runs, {"weighted fit", Mark::curve, true}, line);
}

const Measurement* value_of(const Results& run, const char* name) {
    const Measurement* m = run.find("critical")->find_measurement(name);
    return m != nullptr && m->value && std::isfinite(*m->value) ? m : nullptr;
}

// Where the line meets zero, with its interval, if that is in sight of the points.
void mark_crossing(Figure& figure, const Runs& runs, const std::vector<std::string>& labels,
                   const std::string& parameter) {
    const auto [first, last] = extent(figure, figure.x, &Series::x);
    const auto [bottom, top] = extent(figure, figure.y, &Series::y);
    const double reach = last - first;
    const auto is_in_sight = [&, first = first, last = last](double x) {
        return x > first - reach && x < last + reach;
    };
    const auto ours = [&](const Results& run) { return critical_parameter(run) == parameter; };
    const bool is_one = std::ranges::count_if(runs, ours) == 1;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        if (!ours(runs[r])) continue;
        const Measurement* value = value_of(runs[r], "critical_value");
        if (value == nullptr || !is_in_sight(*value->value)) continue;
        const std::string whose = is_one ? std::string() : ", " + labels[r];
        const Measurement* low = value_of(runs[r], "critical_low");
        const Measurement* high = value_of(runs[r], "critical_high");
        const double* error = value->error ? &*value->error : nullptr;
        add_guide(figure,
                  fmt::format("critical {} = {}{}", parameter,
                              with_minus_signs(with_error(*value->value, error)), whose),
                  {*value->value, *value->value}, {std::min(bottom, 0.0), top});
        if (low == nullptr || high == nullptr) continue;
        if (is_in_sight(*low->value) && is_in_sight(*high->value)) {
            add_band(figure, "68 % interval" + whose, *low->value, *high->value);
        }
    }
}

// "Line through 3 points", "Power 0.73 ± 0.01 through 3 points".
std::string what_is_drawn(const Results& run) {
    const std::size_t count = find_curve(run, points)->find("x")->values.size();
    const auto number_of = [&](const Measurement& m) {
        return with_error(*m.value, m.error ? &*m.error : nullptr);
    };
    const Measurement* power = value_of(run, "power");
    if (power == nullptr) return fmt::format("Line through {} points", count);
    const Measurement* constant = value_of(run, "constant");
    const std::string and_constant =
        constant == nullptr ? "" : " and the constant " + number_of(*constant);
    return fmt::format("Power {}{} through {} points", number_of(*power), and_constant, count);
}

// "Line through 3 points, χ² per degree of freedom 1.0. All runs are fitted anew with one α = 1.33
// ± 0.07; S₀/S₁ of each run alone may differ."
std::string line_sentence(const Results& run) {
    std::string text = what_is_drawn(run);
    if (const Measurement* chi2 = value_of(run, "chi2_per_dof")) {
        text += fmt::format(", χ² per degree of freedom {:.2g}", *chi2->value);
    }
    if (const Measurement* alpha = value_of(run, "alpha")) {
        text += ". All runs are fitted anew with one α = " +
                with_error(*alpha->value, alpha->error ? &*alpha->error : nullptr) +
                "; S₀/S₁ of each run alone may differ";
    }
    return text + ".";
}

Figure against_parameter(const Runs& runs, const std::vector<std::string>& labels,
                         const std::string& parameter, std::size_t place) {
    Figure figure =
        figure_of(labels, place == 0 ? "critical" : fmt::format("critical_{}", place + 1),
                  "S₀/S₁ against " + parameter, {"x", parameter, "", Scale::linear, false});
    figure.group = FigureGroup::critical_point;
    add_kinds(figure, runs);
    std::erase_if(figure.series, [&](const Series& series) {
        return critical_parameter(runs[series.run]) != parameter;
    });
    figure.reading =
        "How far from critical each run is: S₀, what stays at the longest waves, over S₁, how "
        "fast S(k) grows. Where a line meets zero is the critical value.";
    for (const Results& run : runs) {
        if (critical_parameter(run) != parameter) continue;
        add_sentence(figure.note, critical_sentence(run));
        add_sentence(figure.note, line_sentence(run));
    }
    mark_crossing(figure, runs, labels, parameter);
    return figure;
}

// The critical value, if it is known well enough to measure distances from.
const Measurement* critical_value(const Results& run) {
    if (critical_parameter(run).empty()) return nullptr;
    const Measurement* m = run.find("critical")->find_measurement("critical_value");
    const bool is_known = m != nullptr && m->value && m->error && std::isfinite(*m->error) &&
                          *m->error < least_known * std::abs(*m->value);
    return is_known ? m : nullptr;
}

// "ε = (Γc − Γ)/Γc"; in words where the parameter has no symbol or the runs have several.
std::string distance_label(const std::vector<std::string>& parameters) {
    const std::string& first = parameters.front();
    const bool is_one = std::ranges::all_of(
        parameters, [&](const std::string& parameter) { return parameter == first; });
    const bool is_symbol = first == symbol(ControlParameter::acceleration);
    return is_one && is_symbol ? fmt::format("ε = ({0}c − {0})/{0}c", first)
                               : "ε = 1 − control parameter over its critical value";
}

std::optional<Figure> against_distance(const Runs& runs, const std::vector<std::string>& labels) {
    Figure figure = figure_of(labels, "critical_epsilon", "S₀/S₁ against the distance ε",
                              {"epsilon", "", "", Scale::linear, true});
    figure.group = FigureGroup::critical_distance;
    add_kinds(figure, runs);
    const std::string of_fields = symbol(ControlParameter::critical_distance);
    std::vector<std::string> parameters;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        const std::string own = critical_parameter(runs[r]);
        const Measurement* critical = critical_value(runs[r]);
        const bool is_drawn = !own.empty() && own != of_fields && critical != nullptr;
        std::erase_if(figure.series,
                      [&](const Series& series) { return series.run == r && !is_drawn; });
        if (own.empty() || own == of_fields) continue;
        if (!is_drawn) {
            add_sentence(figure.note, labels[r] +
                                          " is not here: its critical value is not known "
                                          "to a quarter.");
            continue;
        }
        const double at = *critical->value;
        for (Series& series : figure.series) {
            if (series.run != r) continue;
            for (double& x : series.x) x = (at - x) / at;
        }
        parameters.push_back(own);
        add_sentence(
            figure.note,
            fmt::format("{}: the error of {} moves all points together by {:.2g}.", labels[r],
                        with_error(at, &*critical->error), std::abs(*critical->error / at)));
    }
    if (figure.series.empty()) return std::nullopt;
    figure.x.label = distance_label(parameters);
    figure.reading =
        "The same against the distance to the critical value, so that runs with different ones can "
        "be compared. A line through the origin means that S₀/S₁ vanishes in proportion to ε.";
    return figure;
}

}  // namespace

std::string critical_parameter(const Results& run) {
    const Curve* curve = find_curve(run, points);
    return curve == nullptr ? std::string() : clean_text(curve->find("x")->meaning);
}

std::vector<Figure> critical_figures(const Runs& runs, const std::vector<std::string>& labels) {
    std::vector<std::string> parameters;
    for (const Results& run : runs) {
        const std::string parameter = critical_parameter(run);
        if (!parameter.empty() && std::ranges::find(parameters, parameter) == parameters.end()) {
            parameters.push_back(parameter);
        }
    }
    std::vector<Figure> figures;
    for (std::size_t p = 0; p < parameters.size(); ++p) {
        figures.push_back(of_present_runs(against_parameter(runs, labels, parameters[p], p)));
    }
    if (auto figure = against_distance(runs, labels)) {
        figures.push_back(of_present_runs(*std::move(figure)));
    }
    return figures;
}

}  // namespace grainfield::report
