#include "analysis/statistics/run_series.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "analysis/order/bond_order_options.h"
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
                    {.label = fmt::format("|Q₄| ≥ {}", solid_order),
                     .from = {"series", "order", "t", "solid_share", ""}}},
         .place = 92},
    };
}

ObservableTitles run_series_titles() {
    return {
        "series",
        "Time series of the run",
        {{"energy_xy", "Horizontal kinetic energy per grain"},
         {"energy_z", "Vertical kinetic energy per grain"},
         {"energy_rotation", "Rotational energy per grain"},
         {"energy_potential", "Potential energy per grain"},
         {"pair", "Pair collisions per grain"},
         {"low_plate", "Collisions with the low plate per grain"},
         {"high_plate", "Collisions with the high plate per grain"},
         {"wall", "Collisions with side walls per grain"},
         {"sliding", "Share of collisions that slid"},
         {"resting", "Rebounds from plates that the TC model raised to its least speed, per grain"},
         {"contact_time", "Collisions that the TC model made elastic, per grain"},
         {"work", "Energy put in by the plates, per grain and period"},
         {"loss_pair", "Energy lost between grains, per grain and period"},
         {"loss_plate", "Energy lost at plates and walls, per grain and period"},
         {"impulse_low", "Mean force of the low plate per grain"},
         {"impulse_high", "Mean force of the high plate per grain"},
         {"pressure", "Pressure"},
         {"q4_mean", "Mean |Q₄|"},
         {"solid_share",
          fmt::format("Share of solid grains, |Q₄| ≥ {} in a snapshot", solid_order)}}};
}

}  // namespace grainfield::analysis
