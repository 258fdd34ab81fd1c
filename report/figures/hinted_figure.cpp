#include "report/figures/hinted_figure.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "report/run_labels.h"
#include "report/text.h"

namespace grainfield::report {

namespace {

bool any_has_curve(const Runs& runs, const CurveColumns& from) {
    return std::ranges::any_of(
        runs, [&](const Results& run) { return find_curve(run, from) != nullptr; });
}

void add_to_list(std::vector<std::string>& list, const std::string& entry) {
    if (std::ranges::find(list, entry) == list.end()) list.push_back(entry);
}

std::string joined(const std::vector<std::string>& parts, const char* between) {
    std::string text;
    for (const std::string& part : parts) text += (text.empty() ? "" : between) + part;
    return text;
}

// The time unit of the first run that has the curve.
TimeUnit shared_time_unit(const Runs& runs, const CurveColumns& from) {
    const auto has_curve = [&](const Results& run) { return find_curve(run, from) != nullptr; };
    const auto first = std::ranges::find_if(runs, has_curve);
    return (first == runs.end() ? runs.front() : *first).source.time_unit;
}

// Whether all runs know their times, in the same unit.
bool share_time(const Runs& runs, const CurveColumns& by_time, const std::string& otherwise) {
    CurveColumns by_other = by_time;
    by_other.x = otherwise;
    const TimeUnit unit = shared_time_unit(runs, by_time);
    return unit != TimeUnit::frame && std::ranges::all_of(runs, [&](const Results& run) {
               return find_curve(run, by_other) == nullptr ||
                      (find_curve(run, by_time) != nullptr && run.source.time_unit == unit);
           });
}

// The units of the x axis as the runs have them; where none has the curve, that of the first run.
std::vector<RunUnit> units_of(const Runs& runs, const CurveColumns& from, const FigureHint& hint,
                              const Axis& x) {
    if (x.unit.is_dimensionless()) return {};
    const bool is_time = x.unit.power(BaseUnit::time) != 0;
    if (is_time && hint.one_time_unit) return {run_unit(x.unit, shared_time_unit(runs, from))};
    std::vector<RunUnit> units = column_units(runs, from);
    if (units.empty()) units.push_back(run_unit(x.unit, runs.front().source.time_unit));
    return units;
}

// The words that tell series apart, in the order in which the runs have them.
std::vector<std::string> words_of(const Runs& runs, const SeriesHint& hint) {
    if (hint.by.empty()) return {""};
    if (!hint.word.empty()) return {hint.word};
    std::vector<std::string> words;
    for (const Results& run : runs) {
        const Curve* curve = find_curve(run, hint.from);
        if (curve == nullptr) continue;
        const auto column = curve->text_columns.find(hint.by);
        if (column == curve->text_columns.end()) continue;
        for (const std::string& word : column->second) add_to_list(words, word);
    }
    return words;
}

std::optional<Series> series_of(const Figure& figure, const Curve& curve, const SeriesHint& hint,
                                const std::string& word) {
    const auto text = curve.text_columns.find(hint.by);
    const auto is_shown = [&](const Axis& axis, double value) {
        return figure.may_be_linear || axis.scale == Scale::linear || value > 0;
    };
    const std::vector<double>& x = curve.find(hint.from.x)->values;
    const std::vector<double>& y = curve.find(hint.from.y)->values;
    auto series = take(curve, hint.from, [&](std::size_t i) {
        if (!is_shown(figure.x, x[i]) || !is_shown(figure.y, y[i])) return false;
        if (hint.by.empty()) return true;
        // Without the column of words a curve is about all particles.
        if (text == curve.text_columns.end()) return word == "all";
        return i < text->second.size() && text->second[i] == word;
    });
    if (!series || series->y.size() < 2 || !(hint.negligible_end > 0)) return series;
    const double most = *std::ranges::max_element(series->y);
    if (series->y.back() > hint.negligible_end * most) return series;
    series->x.pop_back();
    series->y.pop_back();
    if (!series->error.empty()) series->error.pop_back();
    return series;
}

void add_series(Figure& figure, const Runs& runs, const FigureHint& hint, const SeriesHint& which,
                TimeUnit time_unit) {
    for (const std::string& word : words_of(runs, which)) {
        bool found = false;
        for (std::size_t r = 0; r < runs.size(); ++r) {
            const Curve* curve = find_curve(runs[r], which.from);
            if (curve == nullptr) continue;
            if (hint.one_time_unit && runs[r].source.time_unit != time_unit) continue;
            auto series = series_of(figure, *curve, which, word);
            if (!series) continue;
            series->run = r;
            series->kind = figure.kinds.size();
            figure.series.push_back(std::move(*series));
            found = true;
        }
        const std::string label = which.word.empty() ? which.label + word : which.label;
        if (found) figure.kinds.push_back({label, which.mark, which.shown, word});
    }
}

// Runs of which the figure has none of the first curve.
void note_absent(Figure& figure, const Runs& runs, const FigureHint& hint, const CurveColumns& from,
                 std::size_t first_kinds) {
    for (std::size_t r = 0; r < runs.size(); ++r) {
        const bool has = std::ranges::any_of(figure.series, [&](const Series& series) {
            return series.run == r && series.kind < first_kinds;
        });
        if (has) continue;
        const TimeUnit own = runs[r].source.time_unit;
        const bool other_unit = hint.one_time_unit && own != shared_time_unit(runs, from) &&
                                find_curve(runs[r], from) != nullptr;
        figure.absent.push_back({r, other_unit
                                        ? std::string("its times are in ") + typeset_text(own) +
                                              ", not in " + figure.x.unit_text()
                                        : absence(runs[r], from)});
    }
}

void drop_short(Figure& figure, std::size_t least_points) {
    std::erase_if(figure.series, [&](const Series& series) {
        if (series.x.size() >= least_points) return false;
        if (series.kind == 0) {
            figure.absent.push_back({series.run, "one moment only: see the key numbers"});
        }
        return true;
    });
}

// The title of the figure says what the curve is, and what limits it; where the runs differ, each
// curve says so itself.
void entitle(Figure& figure, const Runs& runs, const CurveColumns& from) {
    std::vector<std::string> titles;
    for (const Results& run : runs) {
        if (const Curve* curve = find_curve(run, from)) add_to_list(titles, curve->title);
    }
    if (titles.size() == 1 && !titles.front().empty()) {
        figure.title = titles.front();
    } else if (figure.has_data()) {
        figure.note = "The runs were measured in different ways, see the key numbers";
    }
}

void name_order(Figure& figure, const Runs& runs, const FigureHint& hint) {
    std::vector<std::string> names;
    for (const Results& run : runs) add_to_list(names, order_symbol(run));
    figure.x.label = joined(names, ", ");
    if (figure.x.label == "|Q₄|") figure.note = hint.note_of_square_order;
}

void add_note(Figure& figure, const std::string& note) {
    if (!note.empty()) figure.note += (figure.note.empty() ? "" : ". ") + note;
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

void add_guides(Figure& figure, const Runs& runs, const std::vector<GuideHint>& guides) {
    const auto [first, last] = extent(figure, figure.x, &Series::x);
    const auto [low, high] = extent(figure, figure.y, &Series::y);
    if (guides.empty() || !(last > first) || !(low > 0)) return;
    const bool on_a_line = all_on_a_line(identities_of(runs));
    for (const GuideHint& guide : guides) {
        const bool is_other = on_a_line && guide.on_a_line;
        const double exponent = is_other ? guide.on_a_line->exponent : guide.exponent;
        const std::string& label = is_other ? guide.on_a_line->label : guide.label;
        add_note(figure, guide.note);
        if (guide.place == GuideHint::Place::lowest_corner) {
            add_power_law(figure, label, exponent, first, low, last);
            continue;
        }
        // Above the highest curve where it ends.
        const double from = std::max(first, last / 30);
        add_power_law(figure, label, exponent, from, 1.8 * high * std::pow(from / last, exponent),
                      last);
    }
}

}  // namespace

bool is_present(const Runs& runs, const FigureHint& hint) {
    const CurveColumns& from = hint.series.front().from;
    switch (hint.presence) {
        case Presence::always:
            return true;
        case Presence::with_observable:
            return std::ranges::any_of(
                runs, [&](const Results& run) { return run.find(from.observable) != nullptr; });
        case Presence::with_curve:
            break;
    }
    return any_has_curve(runs, from);
}

Figure hinted_figure(const Runs& runs, const std::vector<std::string>& labels,
                     const FigureHint& hint) {
    std::vector<SeriesHint> kinds = hint.series;
    Axis x = hint.x;
    if (hint.without_time && !share_time(runs, kinds.front().from, hint.without_time->name)) {
        x = *hint.without_time;
        for (SeriesHint& kind : kinds) kind.from.x = x.name;
    }
    const CurveColumns from = kinds.front().from;
    x.units = units_of(runs, from, hint, x);
    Figure figure = empty_figure(labels, hint.name, hint.title, x, hint.y, hint.note);
    figure.may_be_linear = hint.may_be_linear;
    figure.reading = hint.reading;
    const TimeUnit time_unit = shared_time_unit(runs, from);
    std::size_t first_kinds = 0;
    for (const SeriesHint& kind : kinds) {
        add_series(figure, runs, hint, kind, time_unit);
        if (kind.from.observable == from.observable && kind.from.curve == from.curve) {
            first_kinds = figure.kinds.size();
        }
    }
    note_absent(figure, runs, hint, from, first_kinds);
    if (hint.least_points > 1) drop_short(figure, hint.least_points);
    if (hint.x_names_order) name_order(figure, runs, hint);
    if (hint.title_of_curve) entitle(figure, runs, from);
    if (hint.half_of_periodic_box && cut_at_half_box(figure, runs)) {
        add_note(figure, hint.note_of_half_box);
    }
    if (figure.has_data()) add_guides(figure, runs, hint.guides);
    return figure;
}

}  // namespace grainfield::report
