#include "report/figures/figures.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "report/figures/figure_source.h"
#include "report/figures/hinted_figure.h"
#include "report/figures/panels.h"
#include "report/figures/scaled_spectrum.h"
#include "report/page/cards.h"
#include "report/run_labels.h"
#include "report/text.h"

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

// One figure for each control parameter: Γ and ν share no axis.
std::vector<Figure> critical(const Runs& runs, const std::vector<std::string>& labels) {
    std::vector<Figure> figures;
    const CurveColumns points{"critical", "critical", "x", "s0_over_s1", "err"};
    const CurveColumns line{"critical", "critical_line", "x", "s0_over_s1", "err"};
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
        add_kind(figure, runs, {"S₀/S₁", Mark::line, true}, points);
        add_kind(figure, runs, {"weighted line", Mark::curve, true}, line);
        std::erase_if(figure.series, [&](const Series& series) {
            const Curve* curve = find_curve(runs[series.run], points);
            return curve == nullptr || curve->find("x")->meaning != parameters[p];
        });
        figure.reading =
            "How far from critical each run is: S₀, what stays at the longest waves, over S₁, how "
            "fast S(k) grows. Where the line meets zero is the critical value.";
        for (const Results& run : runs) {
            const Curve* curve = find_curve(run, points);
            if (curve == nullptr || curve->find("x")->meaning != parameters[p]) continue;
            if (!figure.note.empty()) figure.note += ' ';
            figure.note += critical_sentence(run);
        }
        figures.push_back(of_present_runs(std::move(figure)));
    }
    return figures;
}

bool any_has(const Runs& runs, const char* observable) {
    return std::ranges::any_of(runs,
                               [&](const Results& run) { return run.find(observable) != nullptr; });
}

constexpr int place_of_scaled_spectrum = 25;  // among those of hints: behind S(k)

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
                                 const std::vector<std::string>& labels,
                                 std::vector<FigureHint> hints) {
    std::vector<Figure> figures = critical(runs, labels);
    const std::vector<RunIdentity> identities = identities_of(runs);
    const auto add = [&](Figure figure, bool by_origin, const std::vector<GuideHint>& guides) {
        std::vector<Figure> panels;
        if (by_origin) panels = panels_by_origin(figure, identities, guides);
        figures.push_back(std::move(figure));
        for (Figure& panel : panels) figures.push_back(std::move(panel));
    };
    bool is_scaled = !any_has(runs, "fit");
    const auto add_scaled = [&] {
        if (!std::exchange(is_scaled, true)) add(scaled_spectrum(runs, labels), true, {});
    };
    std::ranges::stable_sort(hints, {}, &FigureHint::place);
    for (const FigureHint& hint : hints) {
        if (hint.place > place_of_scaled_spectrum) add_scaled();
        if (is_present(runs, hint)) {
            add(hinted_figure(runs, labels, hint), hint.panel_by_origin, hint.guides);
        }
    }
    add_scaled();
    for (Figure& figure : figures) {
        if (figure.runs.size() != identities.size()) continue;  // a panel has one origin
        for (const RunIdentity& identity : identities) {
            figure.origins.push_back(origin_text(identity));
        }
        // Results of `critical` have one curve and no other.
        if (figure.has_data()) {
            std::erase_if(figure.absent, [&](const Figure::Absence& absence) {
                return identities[absence.run].role == RunRole::critical_point;
            });
        }
    }
    return figures;
}

}  // namespace grainfield::report
