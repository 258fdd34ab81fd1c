#include "report/figures/figure_source.h"

#include <algorithm>
#include <utility>

namespace grainfield::report {

Figure empty_figure(const std::vector<std::string>& labels, std::string name, std::string title,
                    Axis x, Axis y, std::string note) {
    Figure figure;
    figure.name = std::move(name);
    figure.title = std::move(title);
    figure.x = std::move(x);
    figure.y = std::move(y);
    figure.runs = labels;
    figure.note = std::move(note);
    return figure;
}

std::string absence(const Results& run, const CurveColumns& source) {
    const ObservableResult* observable = run.find(source.observable);
    if (observable == nullptr) return "not among the observables of this run";
    if (!observable->reason.empty()) return observable->reason;
    const Curve* curve = observable->find_curve(source.curve);
    if (curve == nullptr) return "the results hold no curve '" + source.curve + "'";
    if (curve->find(source.x) == nullptr || curve->find(source.y) == nullptr) {
        return "the curve '" + source.curve + "' lacks the column '" +
               (curve->find(source.x) == nullptr ? source.x : source.y) + "'";
    }
    return "the curve '" + source.curve + "' has no finite value";
}

const Curve* find_curve(const Results& run, const CurveColumns& source) {
    const ObservableResult* observable = run.find(source.observable);
    const Curve* curve = observable == nullptr ? nullptr : observable->find_curve(source.curve);
    if (curve == nullptr) return nullptr;
    const Column* x = curve->find(source.x);
    const Column* y = curve->find(source.y);
    return x == nullptr || y == nullptr || x->values.size() != y->values.size() ? nullptr : curve;
}

void add_kind(Figure& figure, const Runs& runs, Kind kind, const CurveColumns& source) {
    const std::size_t place = figure.kinds.size();
    bool found = false;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        const Curve* curve = find_curve(runs[r], source);
        std::optional<Series> series;
        if (curve != nullptr) series = take(*curve, source, [](std::size_t) { return true; });
        if (series) {
            series->run = r;
            series->kind = place;
            figure.series.push_back(std::move(*series));
            found = true;
        }
    }
    if (found) figure.kinds.push_back(std::move(kind));
}

std::vector<RunUnit> column_units(const Runs& runs, const CurveColumns& source) {
    std::vector<RunUnit> units;
    for (const Results& run : runs) {
        const Curve* curve = find_curve(run, source);
        if (curve == nullptr) continue;
        const RunUnit own = run_unit(curve->find(source.x)->unit, run.source.time_unit);
        if (std::ranges::find(units, own) == units.end()) units.push_back(own);
    }
    return units;
}

}  // namespace grainfield::report
