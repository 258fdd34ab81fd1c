#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/figure_hint.h"
#include "core/results.h"
#include "report/figures/figure.h"

namespace grainfield::report {

using Runs = std::vector<Results>;

Figure empty_figure(const std::vector<std::string>& labels, std::string name, std::string title,
                    Axis x, Axis y, std::string note = "");

/// Why a run has no such curve.
std::string absence(const Results& run, const CurveColumns& source);

/// The curve with both columns of equal length; null if there is none.
const Curve* find_curve(const Results& run, const CurveColumns& source);

/// The rows of a curve that `wanted` accepts; nothing if no row has finite numbers.
template <class Wanted>
std::optional<Series> take(const Curve& curve, const CurveColumns& source, const Wanted& wanted) {
    const std::vector<double>& x = curve.find(source.x)->values;
    const std::vector<double>& y = curve.find(source.y)->values;
    const Column* error = source.error.empty() ? nullptr : curve.find(source.error);
    if (error != nullptr && error->values.size() != x.size()) error = nullptr;
    Series series;
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (!std::isfinite(x[i]) || !std::isfinite(y[i]) || !wanted(i)) continue;
        series.x.push_back(x[i]);
        series.y.push_back(y[i]);
        if (error != nullptr) series.error.push_back(error->values[i]);
    }
    if (series.x.empty()) return std::nullopt;
    return series;
}

/// Adds the series of this kind of every run that has one.
void add_kind(Figure& figure, const Runs& runs, Kind kind, const CurveColumns& source);

/// The units that the runs have in column x, each once: lengths are in a, those of fields in l.
std::vector<RunUnit> column_units(const Runs& runs, const CurveColumns& source);

}  // namespace grainfield::report
