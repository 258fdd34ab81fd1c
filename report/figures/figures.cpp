#include "report/figures/figures.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include "report/figures/critical_figures.h"
#include "report/figures/figure_source.h"
#include "report/figures/hinted_figure.h"
#include "report/figures/panels.h"
#include "report/figures/scaled_spectrum.h"
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

bool any_has(const Runs& runs, const char* observable) {
    return std::ranges::any_of(runs,
                               [&](const Results& run) { return run.find(observable) != nullptr; });
}

// Behind a note that may lack its full stop.
void add_sentence(std::string& note, const std::string& sentence) {
    if (sentence.empty()) return;
    if (!note.empty()) note += note.back() == '.' ? " " : ". ";
    note += sentence;
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
    std::vector<Figure> figures = critical_figures(runs, labels);
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
        add_sentence(figure.note, open_symbols_sentence(figure));
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
