#pragma once

#include "core/results.h"
#include "core/trajectory.h"

namespace grainfield::pipelines {

/// Measures the order of every snapshot that passes through to `next`: a curve "order" with the
/// mean |Q4| of the grains that have one and the share of those with |Q4| ≥ 0.7.
class OrderSeries : public SnapshotSink {
 public:
    /// `period`: the time unit of the curve; `diameter`: that of the grains.
    OrderSeries(SnapshotSink& next, double period, double diameter);

    void write(const Snapshot& snapshot) override;
    const Curve& curve() const { return curve_; }

 private:
    SnapshotSink& next_;
    double period_;
    double diameter_;
    Curve curve_;
};

}  // namespace grainfield::pipelines
