#include "pipelines/analyze/adjusted_snapshots.h"

#include <charconv>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"

namespace grainfield::pipelines {

namespace {

std::optional<double> parse_length(std::string_view text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    if (!std::isfinite(value) || value <= 0) return std::nullopt;
    return value;
}

}  // namespace

Vec2 parse_box_length(std::string_view text) {
    const std::size_t comma = text.find(',');
    if (comma != std::string_view::npos) {
        const auto x = parse_length(text.substr(0, comma));
        const auto y = parse_length(text.substr(comma + 1));
        if (x && y) return {*x, *y};
    }
    throw OptionError({.problem = "option 'box' has a wrong value",
                       .actual = fmt::format("'{}'", text),
                       .expected = "two positive lengths LX,LY in the unit of the positions",
                       .suggestion = "for example --box 100,100"});
}

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
