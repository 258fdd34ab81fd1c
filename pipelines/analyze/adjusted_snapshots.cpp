#include "pipelines/analyze/adjusted_snapshots.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "core/snapshot_check.h"
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
      particles_(static_cast<std::size_t>(source.count()), -1),
      time_(particles_.size(), std::numeric_limits<double>::quiet_NaN()) {
    adjustment_.apply_to(info_);
}

Snapshot AdjustedSnapshots::read(std::int64_t index) {
    throw_if_interrupted("analysis");
    Snapshot snapshot = source_.read(index);
    adjustment_.apply_to(snapshot);
    look_at(snapshot, index);
    return snapshot;
}

void AdjustedSnapshots::look_at(const Snapshot& snapshot, std::int64_t index) {
    std::int64_t& particles = particles_.at(static_cast<std::size_t>(index));
    if (particles >= 0) return;
    particles = static_cast<std::int64_t>(snapshot.size());
    time_[static_cast<std::size_t>(index)] = snapshot.time;
    frames_.insert(snapshot.frame);
    const Box& box = snapshot.box;
    // A disc that the edge of a frame cuts has its centre beside it; periodic boxes fold back.
    const double margin = 0.5 * info_.diameter;
    const auto is_beside = [margin](double x, double origin, double length, Boundary boundary) {
        return boundary == Boundary::walls && (x < origin - margin || x > origin + length + margin);
    };
    for (const Vec2 p : snapshot.position) {
        if (!is_beside(p.x, box.origin.x, box.length.x, box.boundary[0]) &&
            !is_beside(p.y, box.origin.y, box.length.y, box.boundary[1])) {
            continue;
        }
        if (outside_++ == 0) box_ = box;
    }
}

std::vector<std::string> AdjustedSnapshots::warnings() const {
    std::vector<std::string> warnings;
    if (outside_ > 0) {
        const auto read = [](std::int64_t sum, std::int64_t n) { return n > 0 ? sum + n : sum; };
        warnings.push_back(fmt::format(
            "{} of {} points lie outside the box [{:g}, {:g}] × [{:g}, {:g}]; is it the right one "
            "(option 'box')?",
            outside_, std::accumulate(particles_.begin(), particles_.end(), std::int64_t{0}, read),
            box_.origin.x, box_.origin.x + box_.length.x, box_.origin.y,
            box_.origin.y + box_.length.y));
    }
    // NaN: not read.
    std::size_t last = time_.size();
    for (std::size_t k = 0; k < time_.size(); ++k) {
        if (std::isnan(time_[k])) continue;
        if (last < k && !(time_[k] > time_[last])) {
            warnings.push_back(fmt::format(
                "the time stamps do not grow: snapshot {} is at {:g}, the one before it at {:g}; "
                "they are taken as they are",
                k, time_[k], time_[last]));
            break;
        }
        last = k;
    }
    return warnings;
}

std::optional<FilmTimes> AdjustedSnapshots::times() {
    if (time_.size() < 2) return std::nullopt;
    for (std::size_t i = 0; i < time_.size(); ++i) {
        if (particles_[i] < 0) read(static_cast<std::int64_t>(i));
    }
    std::vector<double> steps;
    for (std::size_t i = 1; i < time_.size(); ++i) steps.push_back(time_[i] - time_[i - 1]);
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::ranges::nth_element(steps, middle);
    const FilmTimes times{.interval = *middle, .length = time_.back() - time_.front() + *middle};
    const bool grow = times.interval > 0 && times.length > times.interval;
    return grow && std::isfinite(times.length) ? std::optional(times) : std::nullopt;
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
