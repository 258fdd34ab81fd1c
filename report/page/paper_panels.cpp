#include "report/page/paper_panels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "report/figures/critical_figures.h"
#include "report/figures/figure_source.h"
#include "report/figures/hinted_figure.h"
#include "report/figures/scaled_spectrum.h"
#include "report/text.h"

namespace grainfield::report {

namespace {

constexpr double gamma_of_map = 4.5;  // Fig. 1b
constexpr std::array<std::string_view, 6> of_experiment{"1b", "2a", "2b", "2c", "3", "4a"};
constexpr double exponent_of_fits = 1.12;  // alpha of all fits in Figs. 2a, d, g

const RunIdentity tracked{.origin = Origin::video};
const RunIdentity md{.origin = Origin::md};
const RunIdentity field{.origin = Origin::field, .dimension = 2, .gradient_order = 4};

RunIdentity critical_of(RunIdentity series) {
    series.role = RunRole::critical_point;
    return series;
}

// The results without their pictures.
Results without_previews(const Results& run) {
    Results light;
    light.source = run.source;
    light.identity = run.identity;
    light.label = run.label;
    light.box = run.box;
    light.frames = run.frames;
    light.particles_mean = run.particles_mean;
    light.observables = run.observables;
    return light;
}

struct Subset {
    std::vector<Results> runs;
    std::vector<std::string> labels;
    bool empty() const { return runs.empty(); }
};

// How legends name runs: by what tells those of a panel apart, or as they are labelled.
enum class Legend { control, label };

// What stands for the experiment of the paper.
struct Experiment {
    RunIdentity identity = tracked;
    Legend legend = Legend::control;
};

std::string control_label(const Results& run) {
    if (!run.identity.control) return "";
    return fmt::format("{} = {:.6g}", symbol(run.identity.control->parameter),
                       run.identity.control->value);
}

// The runs of a series that measured an observable, by growing control parameter; their labels are
// its value, where that tells them apart.
Subset of_series(const std::vector<Results>& runs, const std::vector<std::string>& labels,
                 const RunIdentity& series, const char* observable,
                 Legend legend = Legend::control) {
    std::vector<std::size_t> members;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        if (same_series(runs[r].identity, series) && runs[r].find(observable) != nullptr) {
            members.push_back(r);
        }
    }
    const auto control = [&](std::size_t r) {
        const auto& known = runs[r].identity.control;
        return known ? known->value : 0;
    };
    std::ranges::stable_sort(members, {}, control);
    Subset subset;
    for (const std::size_t r : members) {
        const std::string own = control_label(runs[r]);
        const auto same = std::ranges::count_if(
            members, [&](std::size_t other) { return control_label(runs[other]) == own; });
        subset.runs.push_back(without_previews(runs[r]));
        const bool is_labelled = legend == Legend::label || own.empty() || same > 1;
        subset.labels.push_back(is_labelled ? labels[r] : own);
    }
    return subset;
}

// y = (x/a)^alpha where the curves are, as far down as they go: S/S1 at the critical point.
void add_critical_line(Figure& figure, std::string label) {
    const auto [first, last] = extent(figure, figure.x, &Series::x);
    const auto [low, high] = extent(figure, figure.y, &Series::y);
    if (!(last > first) || !(first > 0) || !(low > 0)) return;
    const double from = std::max(first, std::pow(low, 1 / exponent_of_fits));
    const double to = std::min(last, std::pow(high, 1 / exponent_of_fits));
    if (to > from) {
        add_power_law(figure, std::move(label), exponent_of_fits, from,
                      std::pow(from, exponent_of_fits), to);
    }
}

std::string reasons_of(const Figure& figure) {
    std::vector<std::string> reasons;
    for (const Figure::Absence& absence : figure.absent) {
        if (std::ranges::find(reasons, absence.reason) == reasons.end()) {
            reasons.push_back(absence.reason);
        }
    }
    std::string text;
    for (const std::string& reason : reasons) text += (text.empty() ? "" : "; ") + reason;
    return text;
}

const FigureHint* hint_called(const std::vector<FigureHint>& hints, const char* name) {
    const auto hint = std::ranges::find(hints, name, &FigureHint::name);
    return hint == hints.end() ? nullptr : &*hint;
}

// The kinds that are shown, and no others.
void drop_hidden(Figure& figure) {
    std::vector<std::size_t> place(figure.kinds.size(), 0);
    std::vector<Kind> kinds;
    for (std::size_t k = 0; k < figure.kinds.size(); ++k) {
        place[k] = kinds.size();
        if (figure.kinds[k].shown) kinds.push_back(figure.kinds[k]);
    }
    std::erase_if(figure.series, [&](const Series& s) { return !figure.kinds[s.kind].shown; });
    for (Series& series : figure.series) series.kind = place[series.kind];
    figure.kinds = std::move(kinds);
}

// Takes what was drawn, under the name of the panel; what no run has is said in words.
void fill(PaperPanel& panel, Figure figure) {
    if (!figure.has_data()) {
        panel.absent = reasons_of(figure);
        return;
    }
    figure.name = "paper_" + panel.number;
    figure.group = FigureGroup::paper;
    figure.title = panel.number + ": " + panel.title;
    figure.reading.clear();
    figure.origins.clear();
    panel.figure = std::move(figure);
}

void fill_hinted(PaperPanel& panel, const Subset& subset, const std::vector<FigureHint>& hints,
                 const char* name) {
    const FigureHint* hint = hint_called(hints, name);
    if (hint == nullptr || subset.empty()) return;
    fill(panel, hinted_figure(subset.runs, subset.labels, *hint));
}

const Measurement* measurement(const Results& run, const char* observable, const char* name) {
    const ObservableResult* result = run.find(observable);
    return result == nullptr ? nullptr : result->find_measurement(name);
}

std::string measured_text(const Measurement& m) {
    return with_error(*m.value, m.error ? &*m.error : nullptr);
}

// The paper's numbers that the panel shows, each with the run that ours is of: one of `runs`.
void add_lines(PaperPanel& panel, const std::vector<Results>& runs,
               const std::vector<std::string>& labels) {
    for (const PaperValue& paper : paper_values()) {
        if (paper.panel != panel.number) continue;
        const PaperMeasurement found = paper_measurement(paper, runs);
        const Measurement* m = found.measurement;
        const Verdict said = verdict(paper, m);
        panel.lines.push_back(
            {fmt::format("{}: paper {}, ours {}", paper.name, paper_text(paper),
                         m != nullptr && m->value
                             ? fmt::format("{} ({})", measured_text(*m), labels[found.run])
                             : "not measured"),
             said.agreement, said.text()});
    }
}

// Where the slope of ln variance is last known to a tenth, else where it is known best.
std::optional<std::size_t> last_known(const Series& slope) {
    constexpr double known = 0.1;
    std::optional<std::size_t> best;
    for (std::size_t i = slope.error.size(); i-- > 0;) {
        if (!(slope.error[i] > 0)) continue;
        if (slope.error[i] < known) return i;
        if (!best || slope.error[i] < slope.error[*best]) best = i;
    }
    return best;
}

// The slope of ln variance at large windows of the run with the largest control parameter.
void add_growth(PaperPanel& panel, const Subset& subset) {
    for (std::size_t r = subset.runs.size(); r-- > 0;) {
        const Curve* curve =
            find_curve(subset.runs[r], {"variance", "variance_slope", "l", "beta", "err"});
        if (curve == nullptr) continue;
        const auto slope = take(*curve, {"variance", "variance_slope", "l", "beta", "err"},
                                [](std::size_t) { return true; });
        if (!slope) continue;
        const std::optional<std::size_t> at = last_known(*slope);
        const std::string& label = subset.labels[r];
        panel.lines.push_back(
            {!at ? fmt::format("Ours: no β that has an error ({})", label)
                 : fmt::format("Ours: β = {} at ℓ = {:.3g} {} ({})",
                               with_error(slope->y[*at], &slope->error[*at]), slope->x[*at],
                               subset.runs[r].identity.is_field() ? "l" : "a", label),
             Agreement::unresolved, ""});
        return;
    }
}

void add_crossover(PaperPanel& panel, const Subset& subset) {
    for (std::size_t r = subset.runs.size(); r-- > 0;) {
        const Measurement* m = measurement(subset.runs[r], "synthetic", "crossover_length");
        if (m == nullptr || !m->value) continue;
        panel.lines.push_back(
            {fmt::format("Ours: crossover at ℓ* = {} a ({})", measured_text(*m), subset.labels[r]),
             Agreement::unresolved, ""});
        return;
    }
}

PaperPanel spectrum_panel(std::string number, std::string claim, const Subset& subset,
                          const std::vector<Results>& runs,
                          const std::vector<std::string>& labels) {
    PaperPanel panel{.number = std::move(number), .title = "S/S₁", .claim = std::move(claim)};
    add_lines(panel, runs, labels);
    if (subset.empty()) return panel;
    fill(panel, scaled_spectrum(subset.runs, subset.labels));
    if (!panel.figure) return panel;
    add_critical_line(*panel.figure, "paper: (ka)^1.12");
    if (panel.number == "2a") add_band(*panel.figure, "paper: pre-peak, ka ≈ 0.2", 0.15, 0.25);
    return panel;
}

// Against the distance to the critical value where that is known, else against the parameter.
PaperPanel critical_panel(std::string number, std::string claim, const Subset& subset,
                          const std::vector<Results>& runs,
                          const std::vector<std::string>& labels) {
    PaperPanel panel{.number = std::move(number), .title = "S₀/S₁", .claim = std::move(claim)};
    add_lines(panel, runs, labels);
    if (subset.empty()) {
        panel.absent = "no run has an S₀/S₁ with its error";
        return panel;
    }
    std::vector<Figure> figures = critical_figures(subset.runs, subset.labels);
    if (figures.empty()) {
        panel.absent = "no run has an S₀/S₁ with its error";
        return panel;
    }
    Figure& figure = figures.back();
    const bool is_distance = figure.group == FigureGroup::critical_distance;
    const auto value = std::ranges::find_if(
        paper_values(), [&](const PaperValue& v) { return v.panel == panel.number; });
    const Measurement* ours = measurement(subset.runs.front(), "critical", "critical_value");
    if (value != paper_values().end()) {
        double at = value->value;
        double error = value->error;
        if (is_distance) {
            at = (*ours->value - value->value) / *ours->value;
            error = value->error / *ours->value;
        }
        add_band(figure, fmt::format("paper: Γc = {}", paper_text(*value)), at - error, at + error);
    } else if (ours != nullptr && ours->value) {
        panel.lines.push_back(
            {"Ours: zero at ν = " + measured_text(*ours), Agreement::unresolved, ""});
    }
    fill(panel, std::move(figure));
    return panel;
}

PaperPanel variance_panel(std::string number, std::string claim, const Subset& subset,
                          const std::vector<FigureHint>& hints) {
    PaperPanel panel{.number = std::move(number), .title = "σ²", .claim = std::move(claim)};
    fill_hinted(panel, subset, hints, "variance");
    add_growth(panel, subset);
    return panel;
}

PaperPanel order_panel(const std::vector<Results>& runs, const std::vector<std::string>& labels,
                       const std::vector<FigureHint>& hints) {
    PaperPanel panel{.number = "1b",
                     .title = "|Q₄| of the frame",
                     .claim = "Solid patches in a liquid: the distribution has two maxima."};
    Subset subset;
    if (const auto r = run_of_paper_map(runs)) {
        subset.runs.push_back(without_previews(runs[*r]));
        subset.labels.push_back(labels[*r]);
    }
    add_lines(panel, subset.runs, subset.labels);  // of the run that is drawn
    fill_hinted(panel, subset, hints, "q4_histogram");
    if (!panel.figure) return panel;
    const auto [low, high] = extent(*panel.figure, panel.figure->y, &Series::y);
    for (const auto& [name, at] : {std::pair("wide maximum ≈ 0.3", 0.3),
                                   {"minimum ≈ 0.7", 0.7},
                                   {"narrow maximum ≈ 0.95", 0.95}}) {
        add_guide(*panel.figure, std::string("paper: ") + name, {at, at}, {low, high});
    }
    return panel;
}

PaperPanel motion_panel(const Subset& subset, const std::vector<Results>& runs,
                        const std::vector<std::string>& labels,
                        const std::vector<FigureHint>& hints) {
    PaperPanel panel{
        .number = "3",
        .title = "Mean squared displacement",
        .claim = "The liquid diffuses, the faster the larger Γ; the solid is subdiffusive."};
    add_lines(panel, runs, labels);
    fill_hinted(panel, subset, hints, "msd");
    if (panel.figure) {
        for (Kind& kind : panel.figure->kinds) {
            const bool is_wanted = kind.word == "liquid" || kind.word == "solid";
            kind.shown = kind.mark == Mark::guide || (kind.mark == Mark::line && is_wanted);
        }
    }
    for (std::size_t r = subset.runs.size(); r-- > 0;) {
        const Measurement* m = measurement(subset.runs[r], "msd", "exponent_solid");
        if (m == nullptr || !m->value) continue;
        panel.lines.push_back(
            {fmt::format("Solid: paper below 1, ours {} ({})", measured_text(*m), subset.labels[r]),
             Agreement::unresolved, ""});
        break;
    }
    return panel;
}

// Kinds whose word is not wanted are not shown.
template <class Wanted>
void show_only(Figure& figure, const Wanted& wanted) {
    for (Kind& kind : figure.kinds) {
        if (kind.mark != Mark::guide) kind.shown = wanted(kind.word);
    }
}

// Fig. 4a, the boxes of several sides, from the tracked films.
PaperPanel boxes_panel(const Subset& subset, const std::vector<FigureHint>& hints) {
    PaperPanel panel{.number = "4a",
                     .title = "σ² of other boxes, from the S(k) of the films",
                     .claim = "Growth as β = 1 needs boxes far larger than the cell."};
    fill_hinted(panel, subset, hints, "synthetic");
    add_crossover(panel, subset);
    if (!panel.figure) return panel;
    Figure& figure = *panel.figure;
    show_only(figure, [](const std::string& word) { return word != "inf"; });
    const auto [first, last] = extent(figure, figure.x, &Series::x);
    const auto [low, high] = extent(figure, figure.y, &Series::y);
    if (last > first && low > 0) {
        add_power_law(figure, "paper: β = 1", 1, first, low, std::min(last, first * high / low));
    }
    return panel;
}

// Fig. 4b, σ²/ℓ² of the boundless layer, from molecular dynamics.
PaperPanel boundless_panel(const Subset& subset, const std::vector<FigureHint>& hints) {
    PaperPanel panel{.number = "4b",
                     .title = "σ²/ℓ² without bounds, from the S(k) of molecular dynamics",
                     .claim = "It levels off beyond ℓ* ≈ 2πa (S₀/S₁)^(−1/α)."};
    const FigureHint* hint = hint_called(hints, "synthetic");
    if (hint == nullptr || subset.empty()) return panel;
    FigureHint scaled = *hint;
    scaled.y = {"variance_over_area", "σ²(ℓ)/ℓ²", "1/a^2", Scale::log, false};
    scaled.series = {hint->series.front()};
    scaled.series.front().word = "inf";
    scaled.series.front().label = "L → ∞";
    scaled.note.clear();
    Figure figure = hinted_figure(subset.runs, subset.labels, scaled);
    for (Series& series : figure.series) {
        for (std::size_t i = 0; i < series.x.size(); ++i) {
            const double area = series.x[i] * series.x[i];
            series.y[i] /= area;
            if (!series.error.empty()) series.error[i] /= area;
        }
    }
    fill(panel, std::move(figure));
    add_crossover(panel, subset);
    return panel;
}

// All panels of these runs, in the order of the paper.
std::vector<PaperPanel> panels_of(const std::vector<Results>& runs,
                                  const std::vector<std::string>& labels,
                                  const std::vector<FigureHint>& hints,
                                  const Experiment& experiment) {
    const auto [identity, legend] = experiment;
    const auto of_films = [&, identity = identity, legend = legend](const char* observable) {
        return of_series(runs, labels, identity, observable, legend);
    };
    const Subset films = of_films("sk");
    const Subset layers = of_series(runs, labels, md, "sk");
    const Subset fields = of_series(runs, labels, field, "sk");
    const auto critical = [&](const RunIdentity& series, Legend named = Legend::control) {
        return of_series(runs, labels, critical_of(series), "critical", named);
    };
    std::vector<PaperPanel> panels;
    panels.push_back(order_panel(runs, labels, hints));
    panels.push_back(spectrum_panel("2a", "S grows as (ka)^1.12 from S₀/S₁ to a pre-peak.", films,
                                    runs, labels));
    panels.push_back(critical_panel("2b", "A line through the origin of ε.",
                                    critical(identity, legend), runs, labels));
    panels.push_back(variance_panel("2c", "It looks like β = 2.", films, hints));
    panels.push_back(spectrum_panel("2d", "The same in a periodic layer.", layers, runs, labels));
    panels.push_back(
        critical_panel("2e", "A line, its zero left free.", critical(md), runs, labels));
    panels.push_back(
        variance_panel("2f", "Growth below β = 2 also off the critical point.", layers, hints));
    panels.push_back(spectrum_panel("2g", "S₀ + S₁k^α at small k.", fields, runs, labels));
    panels.push_back(critical_panel("2h", "A line that meets zero at a small finite ν.",
                                    critical(field), runs, labels));
    panels.push_back(variance_panel("2i", "As in the layer.", fields, hints));
    panels.push_back(motion_panel(of_films("msd"), runs, labels, hints));
    panels.push_back(boxes_panel(of_films("synthetic"), hints));
    panels.push_back(boundless_panel(of_series(runs, labels, md, "synthetic"), hints));
    for (PaperPanel& panel : panels) {
        if (!panel.figure && panel.absent.empty()) panel.absent = "no run measures it";
        if (!panel.figure) continue;
        panel.figure->absent.clear();
        drop_hidden(*panel.figure);
    }
    return panels;
}

}  // namespace

std::optional<std::size_t> run_of_paper_map(const std::vector<Results>& runs) {
    std::optional<std::size_t> best;
    const auto apart = [&](std::size_t r) {
        const auto& control = runs[r].identity.control;
        return control ? std::abs(control->value - gamma_of_map) : HUGE_VAL;
    };
    // A later one is no better where it is as near: films that were made for |Q4| have more of it.
    for (std::size_t r = 0; r < runs.size(); ++r) {
        if (!same_series(runs[r].identity, tracked) || runs[r].find("q4") == nullptr) continue;
        const bool is_drawn = std::ranges::any_of(
            runs[r].previews, [](const Preview& preview) { return !preview.abs_q4.empty(); });
        if (!is_drawn) continue;
        if (!best || apart(r) < apart(*best) ||
            (apart(r) == apart(*best) && runs[r].previews.size() > runs[*best].previews.size())) {
            best = r;
        }
    }
    return best;
}

std::vector<PaperPanel> paper_panels(const std::vector<Results>& runs,
                                     const std::vector<std::string>& labels,
                                     const std::vector<FigureHint>& hints,
                                     const std::vector<Results>& committed) {
    std::vector<PaperPanel> panels = panels_of(runs, labels, hints, {});
    if (committed.empty()) return panels;
    const Origin origin = committed.front().identity.origin;
    std::vector<std::string> names;
    for (const Results& run : committed) names.push_back(run.label);
    std::vector<PaperPanel> kept =
        panels_of(committed, names, hints, {{.origin = origin}, Legend::label});
    for (std::size_t p = 0; p < panels.size(); ++p) {
        const bool is_wanted =
            std::ranges::find(of_experiment, panels[p].number) != of_experiment.end();
        if (!is_wanted || panels[p].figure || !kept[p].figure) continue;
        panels[p].figure = std::move(kept[p].figure);
        panels[p].committed = origin;
    }
    return panels;
}

std::string paper_verdict(const std::vector<Results>& runs) {
    std::array<std::size_t, 3> count{};
    for (const PaperValue& paper : paper_values()) {
        const Verdict said = verdict(paper, paper_measurement(paper, runs).measurement);
        ++count.at(static_cast<std::size_t>(said.agreement));
    }
    const auto [agree, differ, open] = count;
    return fmt::format(
        "{} of {} numbers of the paper {}, {} differ{}, {} {} not resolved at this "
        "scale",
        agree, paper_values().size(), agree == 1 ? "agrees" : "agree", differ,
        differ == 1 ? "s" : "", open, open == 1 ? "is" : "are");
}

}  // namespace grainfield::report
