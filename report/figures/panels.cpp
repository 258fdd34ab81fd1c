#include "report/figures/panels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace grainfield::report {

namespace {

constexpr std::size_t left_out = std::numeric_limits<std::size_t>::max();

std::string without_origin(const std::string& label, const std::string& origin) {
    const std::string start = origin + ", ";
    return label.starts_with(start) && label.size() > start.size() ? label.substr(start.size())
                                                                   : label;
}

// Of the units of the shared axis those in which fields, or particles, have their lengths.
std::vector<RunUnit> own_units(std::vector<RunUnit> units, bool is_field) {
    if (units.size() < 2) return units;
    std::erase_if(units, [&](const RunUnit& own) {
        return (own.unit.power(BaseUnit::lattice) != 0) != is_field;
    });
    return units;
}

// The guides of the shared figure, or what they are on a line, through the lowest corner of what
// this one shows.
void add_guides(Figure& panel, const Figure& figure, const std::vector<GuideHint>& on_a_line) {
    const auto [first, last] = extent(panel, panel.x, &Series::x);
    const auto [low, high] = extent(panel, panel.y, &Series::y);
    if (!(last > first) || !(low > 0)) return;
    for (const Series& guide : figure.series) {
        if (figure.kinds[guide.kind].mark != Mark::guide) continue;
        double exponent =
            std::log(guide.y.back() / guide.y.front()) / std::log(guide.x.back() / guide.x.front());
        const auto other = std::ranges::find_if(on_a_line, [&](const GuideHint& hint) {
            return hint.on_a_line && hint.label == figure.kinds[guide.kind].label;
        });
        if (other != on_a_line.end()) {
            exponent = other->on_a_line->exponent;
            panel.kinds[guide.kind].label = other->on_a_line->label;
        }
        Series own;
        own.kind = guide.kind;
        for (std::size_t i = 0; i < guide.x.size(); ++i) {
            const double part = static_cast<double>(i) / static_cast<double>(guide.x.size() - 1);
            own.x.push_back(first * std::pow(last / first, part));
            own.y.push_back(low * std::pow(own.x.back() / first, exponent));
        }
        panel.series.push_back(std::move(own));
    }
}

bool has_series(const Figure& figure, std::size_t run) {
    return std::ranges::any_of(figure.series, [&](const Series& s) {
        return s.run == run && figure.kinds[s.kind].mark != Mark::guide;
    });
}

Figure panel_of(const Figure& figure, const std::vector<RunIdentity>& identities,
                const std::string& origin, const std::vector<GuideHint>& guides) {
    Figure panel = figure;
    panel.title += ": " + origin;
    panel.runs.clear();
    panel.series.clear();
    panel.absent.clear();
    bool is_field = false;
    bool on_a_line = false;
    std::vector<std::size_t> place(figure.runs.size(), left_out);
    for (std::size_t r = 0; r < figure.runs.size(); ++r) {
        if (origin_text(identities[r]) != origin || !has_series(figure, r)) continue;
        place[r] = panel.runs.size();
        is_field = identities[r].is_field();
        on_a_line = identities[r].dimension == 1;
        panel.runs.push_back(without_origin(figure.runs[r], origin));
    }
    for (const Series& series : figure.series) {
        const bool guide = figure.kinds[series.kind].mark == Mark::guide;
        if (guide || place[series.run] == left_out) continue;
        panel.series.push_back(series);
        panel.series.back().run = place[series.run];
    }
    panel.x.units = own_units(figure.x.units, is_field);
    const bool is_other = on_a_line && !all_on_a_line(identities);
    add_guides(panel, figure, is_other ? guides : std::vector<GuideHint>());
    return panel;
}

}  // namespace

std::vector<Figure> panels_by_origin(const Figure& figure,
                                     const std::vector<RunIdentity>& identities,
                                     const std::vector<GuideHint>& guides) {
    std::vector<Figure> panels;
    std::size_t origins = 0;
    for (const std::string& origin : origins_of(identities)) {
        Figure panel = panel_of(figure, identities, origin, guides);
        if (!panel.has_data()) continue;
        ++origins;
        // Of one run alone it would repeat what the shared figure shows.
        if (panel.runs.size() > 1) panels.push_back(std::move(panel));
    }
    if (origins < 2) return {};
    for (std::size_t i = 0; i < panels.size(); ++i) {
        panels[i].name += "_panel" + std::to_string(i + 1);
    }
    return panels;
}

Figure of_present_runs(Figure figure) {
    std::vector<std::string> runs;
    std::vector<std::size_t> place(figure.runs.size(), left_out);
    for (std::size_t r = 0; r < figure.runs.size(); ++r) {
        if (!has_series(figure, r)) continue;
        place[r] = runs.size();
        runs.push_back(figure.runs[r]);
    }
    for (Series& series : figure.series) {
        if (figure.kinds[series.kind].mark != Mark::guide) series.run = place[series.run];
    }
    figure.runs = std::move(runs);
    figure.absent.clear();
    return figure;
}

}  // namespace grainfield::report
