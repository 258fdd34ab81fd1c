#include "pipelines/overlay/particle_values.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "analysis/order/bond_order.h"
#include "core/errors.h"
#include "core/support/interrupt.h"

namespace grainfield::pipelines {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr std::int64_t looked_at = 12;  // pairs of frames, for the range of speeds
constexpr double share_below = 0.98;    // of the speeds

[[noreturn]] void refuse(const char* colour, const char* lacking, const char* remedy) {
    throw InputError({.problem = fmt::format("the overlay cannot be coloured by {}", colour),
                      .actual = lacking,
                      .expected = {},
                      .suggestion = remedy});
}

std::string speed_title(TimeUnit unit) {
    switch (unit) {
        case TimeUnit::second:
            return "speed (a/s)";
        case TimeUnit::frame:
            return "speed (a/frame)";
        default:
            return "speed (a / time unit)";
    }
}

/// Up to the next 1, 2 or 5.
double round_up(double value) {
    if (!(value > 0)) return 1;
    const double decade = std::pow(10, std::floor(std::log10(value)));
    for (const double lead : {1.0, 2.0, 5.0}) {
        if (value <= lead * decade) return lead * decade;
    }
    return 10 * decade;
}

}  // namespace

ParticleValues::ParticleValues(OverlayColour colour, SnapshotSource& snapshots)
    : colour_(colour), snapshots_(snapshots), diameter_(snapshots.info().diameter) {
    const Snapshot first = snapshots.read(0);
    switch (colour) {
        case OverlayColour::order:
            break;
        case OverlayColour::speed:
            if (first.velocity.empty() && (first.id.empty() || snapshots.count() < 2)) {
                refuse("speed", "particles have no identities", "link the trajectory");
            }
            find_range();
            break;
        case OverlayColour::layer:
            if (first.layer.empty()) {
                refuse("layer", "the layers are not known", "track with layers.height");
            }
            key_ = {.title = "layer", .classes = {"bottom", "top"}, .other = "unknown"};
            break;
        case OverlayColour::phase:
            find_phases();
            break;
    }
}

void ParticleValues::find_range() {
    key_.title = speed_title(snapshots_.info().time_unit);
    const std::int64_t pairs = std::max<std::int64_t>(1, snapshots_.count() - 1);
    const std::int64_t looks = std::min(pairs, looked_at);
    std::vector<double> all;
    for (std::int64_t i = 0; i < looks; ++i) {
        throw_if_interrupted("overlay");
        const std::int64_t at = i * pairs / looks;
        const Snapshot one = snapshots_.read(at);
        const Snapshot other = at + 1 < snapshots_.count() ? snapshots_.read(at + 1) : one;
        for (const double v : speeds(one, other)) {
            if (std::isfinite(v)) all.push_back(v);
        }
        if (i == 0) before_ = other;  // the first frame moves as it goes on
    }
    if (all.empty()) return;
    const auto place =
        static_cast<std::ptrdiff_t>(share_below * static_cast<double>(all.size() - 1));
    std::ranges::nth_element(all, all.begin() + place);
    key_.high = round_up(all[static_cast<std::size_t>(place)]);
}

std::vector<double> ParticleValues::speeds(const Snapshot& snapshot, const Snapshot& other) const {
    std::vector<double> speed(snapshot.size(), unknown);
    if (!snapshot.velocity.empty()) {
        for (std::size_t i = 0; i < speed.size(); ++i) {
            const Vec3 v = snapshot.velocity[i];
            speed[i] = std::hypot(v.x, v.y) / diameter_;
        }
        return speed;
    }
    const double time = std::abs(snapshot.time - other.time);
    if (!(time > 0) || snapshot.id.empty() || other.id.empty()) return speed;
    std::unordered_map<std::int64_t, Vec2> place;
    for (std::size_t i = 0; i < other.size(); ++i) place.emplace(other.id[i], other.position[i]);
    for (std::size_t i = 0; i < speed.size(); ++i) {
        const auto found = place.find(snapshot.id[i]);
        if (snapshot.id[i] < 0 || found == place.end()) continue;
        const Vec2 step = snapshot.box.minimum_image(snapshot.position[i] - found->second);
        speed[i] = norm(step) / (diameter_ * time);
    }
    return speed;
}

void ParticleValues::find_phases() {
    key_ = {.title = "phase", .classes = {"liquid", "between", "solid"}, .other = "unknown"};
    const std::int64_t count = snapshots_.count();
    history_.emplace(analysis::PhaseOptions{}, snapshots_.info(), count);
    for (std::int64_t i = 0; i < count; ++i) {
        throw_if_interrupted("overlay");
        const Snapshot snapshot = snapshots_.read(i);
        if (snapshot.id.empty() || !history_->follows()) {
            history_.reset();  // every frame stands alone
            return;
        }
        const std::vector<double> q4 = analysis::abs_q4(snapshot, diameter_, {});
        history_->add({snapshot.frame, snapshot.time, snapshot.id, {q4.begin(), q4.end()}});
    }
    history_->close_window();
}

std::vector<double> ParticleValues::phases(const Snapshot& snapshot) const {
    std::vector<double> value(snapshot.size(), unknown);
    if (!history_) {
        const analysis::PhaseOptions limits;
        const std::vector<double> q4 = analysis::abs_q4(snapshot, diameter_, {});
        for (std::size_t i = 0; i < value.size(); ++i) {
            if (!std::isfinite(q4[i])) continue;
            value[i] = q4[i] <= limits.liquid_below ? 0 : q4[i] >= limits.solid_above ? 2 : 1;
        }
        return value;
    }
    const std::int64_t window = history_->window_of(snapshot.time);
    for (std::size_t i = 0; i < value.size(); ++i) {
        std::int64_t first = 0;
        const auto classes = history_->classes(snapshot.id[i], first);
        const std::int64_t at = window - first;
        if (window < 0 || at < 0 || at >= static_cast<std::int64_t>(classes.size())) continue;
        const analysis::Phase phase = classes[static_cast<std::size_t>(at)];
        if (phase != analysis::Phase::unknown) value[i] = static_cast<double>(phase);
    }
    return value;
}

std::vector<double> ParticleValues::next(const Snapshot& snapshot) {
    switch (colour_) {
        case OverlayColour::speed: {
            std::vector<double> speed = speeds(snapshot, before_);
            before_ = snapshot;
            return speed;
        }
        case OverlayColour::layer: {
            std::vector<double> layer;
            for (const Layer l : snapshot.layer) {
                layer.push_back(l == Layer::unknown ? unknown : static_cast<double>(l));
            }
            return layer;
        }
        case OverlayColour::phase:
            return phases(snapshot);
        case OverlayColour::order:
            break;
    }
    return analysis::abs_q4(snapshot, diameter_, {});
}

}  // namespace grainfield::pipelines
