#include "pipelines/analyze/adjusted_snapshots.h"

#include "core/support/interrupt.h"

namespace grainfield::pipelines {

void Adjustment::apply_to(TrajectoryInfo& info) const {
    if (particle_diameter) {
        info.diameter = *particle_diameter;
        info.diameter_origin = DiameterOrigin::given;
    }
    if (acceleration) {
        info.control = {.parameter = ControlParameter::acceleration, .value = *acceleration};
    }
    if (frame_rate) {
        info.frame_rate = frame_rate;
        info.time_unit = TimeUnit::second;
    }
}

void Adjustment::apply_to(Snapshot& snapshot) const {
    if (box_length) snapshot.box.length = *box_length;
    if (boundary) snapshot.box.boundary = {*boundary, *boundary};
    if (frame_rate) snapshot.time = static_cast<double>(snapshot.frame) / *frame_rate;
}

AdjustedSnapshots::AdjustedSnapshots(SnapshotSource& source, const Adjustment& adjustment)
    : source_(source),
      adjustment_(adjustment),
      info_(source.info()),
      particles_(static_cast<std::size_t>(source.count()), -1) {
    adjustment_.apply_to(info_);
}

Snapshot AdjustedSnapshots::read(std::int64_t index) {
    throw_if_interrupted("analysis");
    Snapshot snapshot = source_.read(index);
    adjustment_.apply_to(snapshot);
    particles_.at(static_cast<std::size_t>(index)) = static_cast<std::int64_t>(snapshot.size());
    return snapshot;
}

double AdjustedSnapshots::particles_mean() {
    if (particles_.empty()) return 0;
    double sum = 0;
    for (std::size_t i = 0; i < particles_.size(); ++i) {
        if (particles_[i] < 0) read(static_cast<std::int64_t>(i));
        sum += static_cast<double>(particles_[i]);
    }
    return sum / static_cast<double>(particles_.size());
}

}  // namespace grainfield::pipelines
