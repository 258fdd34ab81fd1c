#include "report/figures/figures.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "report/figures/figure_source.h"
#include "report/figures/further_figures.h"
#include "report/figures/panels.h"
#include "report/run_identity.h"
#include "report/figures/scaled_spectrum.h"
#include "report/page/text.h"

namespace grainfield::report {

namespace {

std::string first_characters(const std::string& text, std::size_t count) {
    std::size_t characters = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool starts = (static_cast<unsigned char>(text[i]) & 0xC0U) != 0x80;
        if (starts && ++characters > count) return text.substr(0, i) + "…";
    }
    return text;
}

// What the curve calls itself, if all runs agree.
std::string common_title(const Runs& runs, const Source& source) {
    std::string title;
    for (const Results& run : runs) {
        const Curve* curve = find_curve(run, source);
        if (curve == nullptr) continue;
        if (!title.empty() && title != curve->title) return "";
        title = curve->title;
    }
    return title;
}

// "|Q₄|", or "|Q₄|, |Q₆|" where runs differ.
std::string common_order(const Runs& runs) {
    std::vector<std::string> names;
    for (const Results& run : runs) {
        const std::string name = order_symbol(run);
        if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
    std::string out;
    for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
    return out;
}

Figure histogram(const Runs& runs, const std::vector<std::string>& labels) {
    Figure figure = empty_figure(labels, "q4_histogram", "Bond-orientational order",
                                 {"q4", common_order(runs), "", Scale::linear, true},
                                 {"density", "Probability density", "", Scale::linear, true});
    add_kind(figure, runs, {"density", Mark::steps, true},
             {"q4", "q4_histogram", "q4", "density", "err"}, true);
    if (figure.x.label == "|Q₄|") {
        figure.note = "Liquid lies near 0.3, the square crystal near 0.95.";
    }
    return figure;
}

// The title of the figure says what the curve is, and what limits it; where the runs differ, each
// curve says so itself.
void entitle(Figure& figure, const std::string& title) {
    if (!title.empty()) {
        figure.title = title;
    } else if (figure.has_data()) {
        figure.note = "The runs were measured in different ways, see the key numbers";
    }
}

Figure structure_factor(const Runs& runs, const std::vector<std::string>& labels) {
    const Source sk{"sk", "sk", "k", "s", "s_err"};
    Figure figure =
        empty_figure(labels, "sk", "Structure factor",
                     {"k", "Wavevector k", common_unit(runs, sk, "1/a"), Scale::log, true},
                     {"s", "S(k)", "", Scale::log, true});
    add_kind(figure, runs, {"S(k)", Mark::line, true}, sk, true);
    add_kind(figure, runs, {"raw, ⟨|ρ|²⟩/N", Mark::line, false},
             {"sk", "sk_raw", "k", "s", "s_err"}, false);
    add_kind(figure, runs, {"modes of a walled box", Mark::line, false},
             {"sk", "sk_neumann", "k", "s", "s_err"}, false);
    add_kind(figure, runs, {"fit, S₀ + S₁ (ka)^α", Mark::curve, true},
             {"fit", "fit", "k", "s", "s_err"}, false);
    figure.may_be_linear = true;
    entitle(figure, common_title(runs, sk));
    return figure;
}

Figure order_structure_factor(const Runs& runs, const std::vector<std::string>& labels) {
    Figure figure = empty_figure(labels, "s4", "Structure factor of the order",
                                 {"k", "Wavevector k", "1/a", Scale::log, true},
                                 {"s", "S₄(k)", "", Scale::log, true});
    const Source s4{"s4", "s4", "k", "s", "s_err"};
    add_kind(figure, runs, {"S₄(k)", Mark::line, true}, s4, true);
    add_kind(figure, runs, {"Ornstein–Zernike, S₄(0)/(1 + (ξ₄k)²)", Mark::curve, true},
             {"s4", "s4_fit", "k", "s", ""}, false);
    figure.may_be_linear = true;
    entitle(figure, common_title(runs, s4));
    return figure;
}

// In periodic boxes windows above half of the side show the fixed number of particles; whether
// something was left out.
bool cut_at_half_box(Figure& figure, const Runs& runs) {
    bool cut = false;
    for (Series& series : figure.series) {
        const Results& run = runs[series.run];
        const double side = std::min(run.box.length.x, run.box.length.y) / run.source.diameter;
        if (!run.box.is_periodic() || !(side > 0)) continue;
        const auto keep = static_cast<std::size_t>(
            std::ranges::upper_bound(series.x, 0.5 * side * (1 + 1e-9)) - series.x.begin());
        if (keep == 0 || keep == series.x.size()) continue;
        series.x.resize(keep);
        series.y.resize(keep);
        if (!series.error.empty()) series.error.resize(keep);
        cut = true;
    }
    return cut;
}

Figure number_variance(const Runs& runs, const std::vector<std::string>& labels) {
    const Source source{"variance", "variance", "l", "variance", "err"};
    Figure figure =
        empty_figure(labels, "variance", "Number variance",
                     {"l", "Window side ℓ", common_unit(runs, source, "a"), Scale::log, false},
                     {"variance", "σ²(ℓ)", "", Scale::log, false});
    add_kind(figure, runs, {"σ²(ℓ)", Mark::line, true}, source, true);
    add_kind(figure, runs, {"pooled over positions and frames", Mark::line, false},
             {"variance", "variance_pooled", "l", "variance", "err"}, false);
    add_kind(figure, runs, {"of the spatial mean", Mark::line, false},
             {"variance", "variance_spatial_mean", "l", "variance", "err"}, false);
    entitle(figure, common_title(runs, source));
    const bool cut = cut_at_half_box(figure, runs);
    if (!figure.has_data()) return figure;
    if (cut) {
        figure.note += figure.note.empty() ? "" : ". ";
        figure.note +=
            "Drawn up to half of a periodic box: the fixed number of particles pulls σ² to zero at "
            "ℓ = L";
    }
    const auto [first, last] = extent(figure, figure.x, &Series::x);
    const auto [low, high] = extent(figure, figure.y, &Series::y);
    if (!(last > first) || !(low > 0)) return figure;
    figure.note += figure.note.empty() ? "" : ". ";
    figure.note += "Guides: σ² ∝ ⟨N⟩^(β/2), in the plane ℓ^β, on a line ℓ^(β/2).";
    const double line = all_on_a_line(identities_of(runs)) ? 0.5 : 1;
    add_power_law(figure, "β = 1", 1 * line, first, low, last);
    add_power_law(figure, "β = 2", 2 * line, first, low, last);
    return figure;
}

// The time unit of the first run that has an MSD; runs in another unit cannot share its axis.
TimeUnit shared_time_unit(const Runs& runs, const Source& source) {
    const auto has_curve = [&](const Results& run) { return find_curve(run, source) != nullptr; };
    const auto first = std::ranges::find_if(runs, has_curve);
    return (first == runs.end() ? runs.front() : *first).source.time_unit;
}

Figure displacement(const Runs& runs, const std::vector<std::string>& labels) {
    const Source source{"msd", "msd", "t", "msd", "err"};
    const TimeUnit time_unit = shared_time_unit(runs, source);
    const std::string unit = pretty_unit("time unit", time_unit);
    Figure figure = empty_figure(labels, "msd", "Mean squared displacement",
                                 {"t", "Lag time t", unit, Scale::log, false},
                                 {"msd", "MSD", "a²", Scale::log, false});
    std::vector<bool> found(runs.size(), false);
    for (const std::string phase : {"all", "liquid", "solid"}) {
        const std::size_t place = figure.kinds.size();
        bool any = false;
        for (std::size_t r = 0; r < runs.size(); ++r) {
            const Curve* curve = find_curve(runs[r], source);
            if (curve == nullptr || runs[r].source.time_unit != time_unit) continue;
            const auto text = curve->text_columns.find("phase");
            const bool has_phases = text != curve->text_columns.end();
            auto series = take(*curve, source, [&](std::size_t i) {
                if (!has_phases) return phase == "all";
                return i < text->second.size() && text->second[i] == phase;
            });
            if (!series) continue;
            series->run = r;
            series->kind = place;
            figure.series.push_back(std::move(*series));
            found[r] = any = true;
        }
        if (any) figure.kinds.push_back({phase, Mark::line, true});
    }
    for (const std::string phase : {"all", "liquid", "solid"}) {
        const std::size_t place = figure.kinds.size();
        bool any = false;
        for (std::size_t r = 0; r < runs.size(); ++r) {
            const Source line{"msd", "msd_fit", "t", "msd", ""};
            const Curve* curve = find_curve(runs[r], line);
            if (curve == nullptr || runs[r].source.time_unit != time_unit) continue;
            const auto& words = curve->text_columns.at("phase");
            auto series = take(*curve, line, [&](std::size_t i) { return words.at(i) == phase; });
            if (!series) continue;
            series->run = r;
            series->kind = place;
            figure.series.push_back(std::move(*series));
            any = true;
        }
        if (any) figure.kinds.push_back({phase + ", 4 D t + c", Mark::curve, true});
    }
    for (std::size_t r = 0; r < runs.size(); ++r) {
        if (found[r]) continue;
        const TimeUnit own = runs[r].source.time_unit;
        const bool other_unit = own != time_unit && find_curve(runs[r], source) != nullptr;
        figure.absent.push_back(
            {r, other_unit
                    ? "its times are in " + pretty_unit("time unit", own) + ", not in " + unit
                    : absence(runs[r], source)});
    }
    if (!figure.has_data()) return figure;
    const auto [first, last] = extent(figure, figure.x, &Series::x);
    const auto [low, high] = extent(figure, figure.y, &Series::y);
    if (!(last > first) || !(low > 0)) return figure;
    // Above the highest curve where it ends.
    const double from = std::max(first, last / 30);
    add_power_law(figure, "slope 1", 1, from, 1.8 * high * from / last, last);
    figure.note = "Diffusion has slope 1.";
    return figure;
}

// Against time where all runs know theirs in the same unit, else against the frame number.
Figure phase_fractions(const Runs& runs, const std::vector<std::string>& labels) {
    const Source by_time{"phase", "phase", "t", "solid_fraction", ""};
    const TimeUnit unit = shared_time_unit(runs, by_time);
    const bool timed =
        unit != TimeUnit::frame && std::ranges::all_of(runs, [&](const Results& run) {
            const Source by_frame{"phase", "phase", "frame", "solid_fraction", ""};
            return find_curve(run, by_frame) == nullptr ||
                   (find_curve(run, by_time) != nullptr && run.source.time_unit == unit);
        });
    const Axis time{"t", "Time t", pretty_unit("time unit", unit), Scale::linear, false};
    const Axis frame{"frame", "Frame", "", Scale::linear, false};
    Figure figure = empty_figure(labels, "phase", "Phases", timed ? time : frame,
                                 {"fraction", "Fraction of particles", "", Scale::linear, true});
    add_kind(figure, runs, {"solid", Mark::line, true},
             {"phase", "phase", figure.x.name, "solid_fraction", ""}, true);
    add_kind(figure, runs, {"liquid", Mark::line, true},
             {"phase", "phase", figure.x.name, "liquid_fraction", ""}, false);
    std::erase_if(figure.series, [&](const Series& series) {
        if (series.x.size() > 1) return false;
        if (series.kind == 0) {
            figure.absent.push_back({series.run, "one moment only: see the key numbers"});
        }
        return true;
    });
    return figure;
}

// One figure for each control parameter: Γ and ν share no axis.
std::vector<Figure> critical(const Runs& runs, const std::vector<std::string>& labels) {
    std::vector<Figure> figures;
    const Source points{"critical", "critical", "x", "s0_over_s1", "err"};
    const Source line{"critical", "critical_line", "x", "s0_over_s1", "err"};
    std::vector<std::string> parameters;
    for (const Results& run : runs) {
        const Curve* curve = find_curve(run, points);
        if (curve == nullptr) continue;
        const std::string& parameter = curve->find("x")->meaning;
        if (std::ranges::find(parameters, parameter) == parameters.end()) {
            parameters.push_back(parameter);
        }
    }
    for (std::size_t p = 0; p < parameters.size(); ++p) {
        const std::string name = clean_text(parameters[p]);
        Figure figure =
            empty_figure(labels, p == 0 ? "critical" : fmt::format("critical_{}", p + 1),
                         "S₀/S₁ against " + name, {"x", name, "", Scale::linear, false},
                         {"s0_over_s1", "S₀/S₁", "", Scale::linear, true});
        add_kind(figure, runs, {"S₀/S₁", Mark::line, true}, points, false);
        add_kind(figure, runs, {"weighted line", Mark::curve, true}, line, false);
        std::erase_if(figure.series, [&](const Series& series) {
            const Curve* curve = find_curve(runs[series.run], points);
            return curve == nullptr || curve->find("x")->meaning != parameters[p];
        });
        figure.note = "Where a line meets zero is the critical value, see the key numbers.";
        figures.push_back(of_present_runs(std::move(figure)));
    }
    return figures;
}

/// Columns of the time series of a simulation, against its time.
Figure run_series(const Runs& runs, const std::vector<std::string>& labels, const char* name,
                  const char* title, const Axis& y,
                  const std::vector<std::pair<const char*, const char*>>& columns) {
    Figure figure =
        empty_figure(labels, name, title, {"t", "Time t", "periods", Scale::linear, true}, y);
    for (const auto& [column, label] : columns) {
        add_kind(figure, runs, {label, Mark::curve, true}, {"series", "md", "t", column, ""},
                 column == columns.front().first);
    }
    return figure;
}

Figure energies(const Runs& runs, const std::vector<std::string>& labels) {
    return run_series(
        runs, labels, "energies", "Energies of the run",
        {"energy", "Energy per grain", "m g a", Scale::linear, true},
        {{"energy_xy", "horizontal"}, {"energy_z", "vertical"}, {"energy_rotation", "rotation"}});
}

Figure collisions(const Runs& runs, const std::vector<std::string>& labels) {
    return run_series(runs, labels, "collisions", "Collisions of the run",
                      {"rate", "Collisions per grain", "1/period", Scale::linear, true},
                      {{"pair", "between grains"},
                       {"low_plate", "with the low plate"},
                       {"high_plate", "with the high plate"}});
}

Figure order_of_run(const Runs& runs, const std::vector<std::string>& labels) {
    Figure figure = empty_figure(
        labels, "order", "Order of the snapshots", {"t", "Time t", "periods", Scale::linear, true},
        {"value", "Mean |Q₄|, share of solid grains", "", Scale::linear, true});
    add_kind(figure, runs, {"mean |Q₄|", Mark::line, true}, {"series", "order", "t", "q4_mean", ""},
             true);
    add_kind(figure, runs, {"|Q₄| ≥ 0.7", Mark::line, true},
             {"series", "order", "t", "solid_share", ""}, false);
    return figure;
}

bool any_has(const Runs& runs, const char* observable) {
    return std::ranges::any_of(runs,
                               [&](const Results& run) { return run.find(observable) != nullptr; });
}

}  // namespace

std::vector<std::string> run_labels(const std::vector<Results>& runs) {
    std::vector<std::string> labels;
    for (const Results& run : runs) {
        std::string label = clean_text(run.label);
        if (label.find_first_not_of(' ') == std::string::npos) {
            label = run.record.inputs.empty()
                        ? "run " + std::to_string(labels.size() + 1)
                        : std::filesystem::path(clean_text(run.record.inputs.front().name))
                              .filename()
                              .string();
        }
        label = first_characters(label, 60);
        const std::string plain = label;
        for (int i = 2; std::ranges::find(labels, label) != labels.end(); ++i) {
            label = plain + " (" + std::to_string(i) + ")";
        }
        labels.push_back(label);
    }
    return labels;
}

std::vector<Figure> make_figures(const std::vector<Results>& runs,
                                 const std::vector<std::string>& labels) {
    std::vector<Figure> figures = critical(runs, labels);
    const auto add = [&](Figure figure) { figures.push_back(std::move(figure)); };
    const std::vector<RunIdentity> identities = identities_of(runs);
    const auto add_with_panels = [&](Figure figure) {
        std::vector<Figure> panels = panels_by_origin(figure, identities);
        add(std::move(figure));
        for (Figure& panel : panels) add(std::move(panel));
    };
    add(histogram(runs, labels));
    add(structure_factor(runs, labels));
    if (any_has(runs, "fit")) add_with_panels(scaled_spectrum(runs, labels));
    add_with_panels(number_variance(runs, labels));
    add_with_panels(displacement(runs, labels));
    add(phase_fractions(runs, labels));
    if (any_has(runs, "s4")) add(order_structure_factor(runs, labels));
    for (Figure& figure : further_figures(runs, labels)) {
        if (figure.name == "synthetic") {
            add_with_panels(std::move(figure));
        } else {
            add(std::move(figure));
        }
    }
    if (any_has(runs, "series")) {
        add(energies(runs, labels));
        add(collisions(runs, labels));
        Figure order = order_of_run(runs, labels);
        if (order.has_data()) add(std::move(order));
    }
    for (Figure& figure : figures) {
        if (figure.runs.size() != identities.size()) continue;  // a panel has one origin
        for (const RunIdentity& identity : identities) figure.origins.push_back(identity.origin);
        // Results of `critical` have one curve and no other.
        if (figure.has_data()) {
            std::erase_if(figure.absent, [&](const Figure::Absence& absence) {
                return identities[absence.run].origin == "critical";
            });
        }
    }
    return figures;
}

}  // namespace grainfield::report
