#include "analysis/statistics/run_series.h"

#include <cmath>
#include <utility>

#include "analysis/statistics/blocks.h"

namespace grainfield::analysis {

namespace {

Measurement late_mean(const Column& column) {
    MeanSeries late;
    for (std::size_t i = column.values.size() / 2; i < column.values.size(); ++i) {
        if (std::isfinite(column.values[i])) late.add(column.values[i]);
    }
    if (late.value.empty()) return missing(column.name, column.unit.text(), "no finite value");
    return late.measurement(column.name, column.unit.text(), std::nullopt,
                            "one row: nothing to take an error from");
}

}  // namespace

ObservableResult run_series(std::vector<Curve> curves) {
    ObservableResult result;
    result.name = "series";
    for (const Curve& curve : curves) {
        if (curve.find("t") == nullptr || curve.find("t")->values.empty()) continue;
        for (const Column& column : curve.columns) {
            if (column.name == "t" || column.name == "audit") continue;
            result.measurements.push_back(late_mean(column));
        }
    }
    if (result.measurements.empty()) result.reason = "the file holds no rows of a time series";
    result.curves = std::move(curves);
    return result;
}

std::vector<FigureHint> run_series_figures() {
    const Axis time{"t", "Time t", "periods", Scale::linear, true};
    const auto column = [](const char* label, const char* name) {
        return SeriesHint{
            .label = label, .mark = Mark::curve, .from = {"series", "md", "t", name, ""}};
    };
    return {
        {.name = "energies",
         .title = "Energies of the run",
         .note = "",
         .x = time,
         .y = {"energy", "Energy per grain", "m g a", Scale::linear, true},
         .series = {column("horizontal", "energy_xy"), column("vertical", "energy_z"),
                    column("rotation", "energy_rotation")},
         .place = 90,
         .presence = Presence::with_observable},
        {.name = "collisions",
         .title = "Collisions of the run",
         .note = "",
         .x = time,
         .y = {"rate", "Collisions per grain", "1/period", Scale::linear, true},
         .series = {column("between grains", "pair"), column("with the low plate", "low_plate"),
                    column("with the high plate", "high_plate")},
         .place = 91,
         .presence = Presence::with_observable},
        {.name = "order",
         .title = "Order of the snapshots",
         .note = "",
         .x = time,
         .y = {"value", "Mean |Q₄|, share of solid grains", "", Scale::linear, true},
         .series = {{.label = "mean |Q₄|", .from = {"series", "order", "t", "q4_mean", ""}},
                    {.label = "|Q₄| ≥ 0.7", .from = {"series", "order", "t", "solid_share", ""}}},
         .place = 92},
    };
}

}  // namespace grainfield::analysis
