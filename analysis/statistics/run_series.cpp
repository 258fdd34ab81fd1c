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
    if (late.value.empty()) return missing(column.name, column.unit, "no finite value");
    return late.measurement(column.name, column.unit, std::nullopt,
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

}  // namespace grainfield::analysis
