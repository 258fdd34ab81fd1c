#include "pipelines/md/order_series.h"

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "analysis/order/bond_order.h"

namespace grainfield::pipelines {

namespace {

using analysis::solid_order;

}  // namespace

OrderSeries::OrderSeries(SnapshotSink& next, double period, double diameter)
    : next_(next), period_(period), diameter_(diameter) {
    curve_ = {
        .name = "order", .title = "Order of the snapshots", .columns = {}, .text_columns = {}};
    curve_.columns = {{"t", "periods", "time", {}},
                      {"q4_mean", "-", "mean |Q4|", {}},
                      {"solid_share",
                       "-",
                       fmt::format("share of grains with |Q4| ≥ {} in the snapshot", solid_order),
                       {}}};
}

void OrderSeries::write(const Snapshot& snapshot) {
    next_.write(snapshot);
    double sum = 0, solid = 0, count = 0;
    for (const double q4 : analysis::abs_q4(snapshot, diameter_, {})) {
        if (!std::isfinite(q4)) continue;
        sum += q4;
        solid += q4 >= solid_order ? 1 : 0;
        count += 1;
    }
    constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
    const double values[] = {snapshot.time / period_, count > 0 ? sum / count : nothing,
                             count > 0 ? solid / count : nothing};
    for (std::size_t i = 0; i < curve_.columns.size(); ++i) {
        curve_.columns[i].values.push_back(values[i]);
    }
}

}  // namespace grainfield::pipelines
