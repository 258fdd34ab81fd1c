#include "report/figures/further_figures.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "report/page/text.h"

namespace grainfield::report {

namespace {

using Runs = std::vector<Results>;

// Where the values of a figure stand, and the column of words that tells series apart.
struct Source {
    std::string observable, curve, x, y, error, by;
};

const Curve* find_curve(const Results& run, const Source& source) {
    const ObservableResult* observable = run.find(source.observable);
    const Curve* curve = observable == nullptr ? nullptr : observable->find_curve(source.curve);
    if (curve == nullptr || curve->find(source.x) == nullptr) return nullptr;
    return curve->find(source.y) == nullptr ? nullptr : curve;
}

std::string absence(const Results& run, const Source& source) {
    const ObservableResult* observable = run.find(source.observable);
    if (observable == nullptr) return "not among the observables of this run";
    return observable->reason.empty() ? "the results hold no curve '" + source.curve + "'"
                                      : observable->reason;
}

// The words in the order in which the runs have them; one empty word if there is no such column.
std::vector<std::string> words_of(const Runs& runs, const Source& source) {
    if (source.by.empty()) return {""};
    std::vector<std::string> words;
    for (const Results& run : runs) {
        const Curve* curve = find_curve(run, source);
        if (curve == nullptr) continue;
        const auto column = curve->text_columns.find(source.by);
        if (column == curve->text_columns.end()) continue;
        for (const std::string& word : column->second) {
            if (std::ranges::find(words, word) == words.end()) words.push_back(word);
        }
    }
    return words;
}

bool is_shown(const Axis& axis, double value) {
    return std::isfinite(value) && (axis.scale == Scale::linear || value > 0);
}

Series series_of(const Figure& figure, const Curve& curve, const Source& source,
                 const std::string& word) {
    Series series;
    const Column* error = source.error.empty() ? nullptr : curve.find(source.error);
    for (std::size_t i = 0; i < curve.find(source.x)->values.size(); ++i) {
        if (!source.by.empty() && curve.text_columns.at(source.by).at(i) != word) continue;
        const double x = curve.find(source.x)->values[i];
        const double y = curve.find(source.y)->values[i];
        if (!is_shown(figure.x, x) || !is_shown(figure.y, y)) continue;
        series.x.push_back(x);
        series.y.push_back(y);
        if (error != nullptr) series.error.push_back(error->values[i]);
    }
    return series;
}

void add_kind(Figure& figure, const Runs& runs, const Kind& kind, const Source& source,
              const std::string& word = "") {
    const std::size_t place = figure.kinds.size();
    bool found = false;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        const Curve* curve = find_curve(runs[r], source);
        if (curve == nullptr) continue;
        Series series = series_of(figure, *curve, source, word);
        if (series.x.empty()) continue;
        series.run = r;
        series.kind = place;
        figure.series.push_back(std::move(series));
        found = true;
    }
    if (found) figure.kinds.push_back(kind);
}

void note_absent(Figure& figure, const Runs& runs, const Source& source) {
    for (std::size_t r = 0; r < runs.size(); ++r) {
        const bool has = std::ranges::any_of(figure.series,
                                             [r](const Series& series) { return series.run == r; });
        if (!has) figure.absent.push_back({r, absence(runs[r], source)});
    }
}

bool any_has(const Runs& runs, const Source& source) {
    return std::ranges::any_of(
        runs, [&](const Results& run) { return find_curve(run, source) != nullptr; });
}

constexpr const char* kTime = "time unit";

// The unit of the x axis as the runs that have the curve have it; "a or l" where they differ.
std::string unit_of(const Runs& runs, const Source& source, const Axis& axis) {
    if (axis.unit.empty()) return "";
    std::vector<std::string> units;
    for (const Results& run : runs) {
        const Curve* curve = find_curve(run, source);
        if (curve == nullptr) continue;
        const std::string unit = axis.unit == kTime ? pretty_unit("time unit", run.source.time_unit)
                                                    : curve->find(source.x)->unit;
        if (std::ranges::find(units, unit) == units.end()) units.push_back(unit);
    }
    std::string joined;
    for (const std::string& unit : units) joined += joined.empty() ? unit : " or " + unit;
    return joined;
}

struct Plan {
    std::string name, title, note;
    Axis x, y;
    Source source;
    std::string label;
};

Figure drawn(const Runs& runs, const std::vector<std::string>& labels, const Plan& plan) {
    Figure figure;
    figure.name = plan.name;
    figure.title = plan.title;
    figure.note = plan.note;
    figure.x = plan.x;
    figure.y = plan.y;
    figure.x.unit = unit_of(runs, plan.source, plan.x);
    figure.runs = labels;
    for (const std::string& word : words_of(runs, plan.source)) {
        const std::string label = word.empty() ? plan.label : plan.label + word;
        add_kind(figure, runs, {label, Mark::line, true}, plan.source, word);
    }
    note_absent(figure, runs, plan.source);
    return figure;
}

Figure synthetic(const Runs& runs, const std::vector<std::string>& labels) {
    const Source source{"synthetic", "synthetic", "l", "variance", "err", "side"};
    Figure figure =
        drawn(runs, labels,
              {"synthetic",
               "Number variance of other boxes, from S(k)",
               "Boxes are periodic with a fixed number of particles: σ² vanishes at ℓ = L. Above "
               "the measured k S = 1 is taken (of a field its last value), which shows at small ℓ.",
               {"l", "Window side ℓ", "a", Scale::log, false},
               {"variance", "σ²(ℓ)", "", Scale::log, false},
               source,
               "L = "});
    // σ² is zero at ℓ = L but for rounding: nothing to draw on a logarithmic axis.
    for (Series& series : figure.series) {
        const double most = *std::ranges::max_element(series.y);
        if (series.y.size() < 2 || series.y.back() > 1e-6 * most) continue;
        series.x.pop_back();
        series.y.pop_back();
        if (!series.error.empty()) series.error.pop_back();
    }
    add_kind(figure, runs, {"counted", Mark::line, true},
             {"variance", "variance", "l", "variance", "err", ""});
    return figure;
}

}  // namespace

std::vector<Figure> further_figures(const std::vector<Results>& runs,
                                    const std::vector<std::string>& labels) {
    const Axis lag{"t", "Lag time τ", kTime, Scale::log, false};
    const std::vector<Plan> plans{{"variance_slope",
                                   "Local exponent of the number variance",
                                   "β = 2: σ² ∝ ⟨N⟩; β = 1: σ² ∝ the perimeter.",
                                   {"l", "Window side ℓ", "a", Scale::log, false},
                                   {"beta", "β(ℓ) = d ln σ²/d ln ℓ", "", Scale::linear, true},
                                   {"variance", "variance_slope", "l", "beta", "err", ""},
                                   "β(ℓ)"},
                                  {"sk_order",
                                   "Structure factor of the order field",
                                   "",
                                   {"k", "Wavevector k", "1/l", Scale::log, false},
                                   {"s", "S_ψ(k)", "", Scale::log, false},
                                   {"sk_order", "sk_order", "k", "s", "s_err", ""},
                                   "S_ψ(k)"},
                                  {"sk_anisotropy",
                                   "Anisotropy of S(k)",
                                   "",
                                   {"k", "Wavevector k", "1/a", Scale::log, true},
                                   {"a4", "Amplitude of the harmonic", "", Scale::linear, true},
                                   {"sk", "sk_anisotropy", "k", "a4", "", ""},
                                   "four-fold"},
                                  {"q4_space",
                                   "Correlation of the order in space",
                                   "",
                                   {"r", "Distance r", "a", Scale::linear, true},
                                   {"c", "⟨Re Q*(0) Q(r)⟩/⟨|Q|²⟩", "", Scale::linear, true},
                                   {"q4", "q4_space", "r", "c", "err", ""},
                                   "C(r)"},
                                  {"q4_time",
                                   "Correlation of the order in time",
                                   "",
                                   lag,
                                   {"c", "⟨Re Q*(t) Q(t + τ)⟩/⟨|Q|²⟩", "", Scale::linear, true},
                                   {"q4", "q4_time", "t", "c", "err", ""},
                                   "C(τ)"},
                                  {"q4_fluctuation",
                                   "Fluctuation of the order of a particle",
                                   "Mean and standard deviation of |Q| in the averaging time.",
                                   {"m", "Mean |Q₄|", "", Scale::linear, true},
                                   {"sigma", "Standard deviation of |Q₄|", "", Scale::linear, true},
                                   {"phase", "q4_fluctuation", "m", "sigma", "err", ""},
                                   "σ(m)"},
                                  {"q4_examples",
                                   "Order of a typical particle of each phase",
                                   "Through one averaging time.",
                                   {"t", "Time", kTime, Scale::linear, true},
                                   {"q4", "|Q₄|", "", Scale::linear, true},
                                   {"phase", "q4_examples", "t", "q4", "", "phase"},
                                   ""},
                                  {"clusters",
                                   "Sizes of the solid clusters",
                                   "",
                                   {"size", "Particles in the cluster", "", Scale::log, false},
                                   {"clusters", "Clusters a window", "", Scale::log, false},
                                   {"phase", "clusters", "size", "clusters", "err", ""},
                                   "clusters"},
                                  {"van_hove",
                                   "Self part of the van Hove function",
                                   "",
                                   {"x", "Displacement along an axis", "a", Scale::linear, true},
                                   {"g", "Density", "1/a", Scale::log, false},
                                   {"msd", "van_hove", "x", "g", "err", "lag"},
                                   "lag of frames: "}};
    std::vector<Figure> figures;
    if (any_has(runs, {"synthetic", "synthetic", "l", "variance", "err", "side"})) {
        figures.push_back(synthetic(runs, labels));
    }
    for (const Plan& plan : plans) {
        if (!any_has(runs, plan.source)) continue;
        figures.push_back(drawn(runs, labels, plan));
        if (plan.name != "sk_anisotropy") continue;
        add_kind(figures.back(), runs, {"two-fold", Mark::line, true},
                 {"sk", "sk_anisotropy", "k", "a2", "", ""});
        add_kind(figures.back(), runs, {"four-fold by chance, if isotropic", Mark::curve, true},
                 {"sk", "sk_anisotropy", "k", "chance4", "", ""});
    }
    return figures;
}

}  // namespace grainfield::report
