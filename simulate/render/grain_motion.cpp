#include "simulate/render/grain_motion.h"

#include <cmath>
#include <unordered_map>

namespace grainfield::simulate {

namespace {

constexpr double standard_gravity = 9.80665;  // [m/s²]

double height_of(const Snapshot& s, std::size_t i, double diameter, double cell_height) {
    if (!s.z.empty()) return s.z[i] / diameter;
    if (!s.layer.empty() && s.layer[i] == Layer::top) return cell_height - 0.5;
    return 0.5;
}

void add_chords(const Snapshot& now, const Snapshot& next, double diameter, double seconds,
                GrainMotion& motion) {
    if (now.id.empty() || next.id.empty() || !(seconds > 0)) return;
    std::unordered_map<std::int64_t, std::size_t> later;
    for (std::size_t i = 0; i < next.id.size(); ++i) later.emplace(next.id[i], i);
    motion.velocity.assign(now.size(), Vec3{});
    for (std::size_t i = 0; i < now.size(); ++i) {
        const auto found = later.find(now.id[i]);
        if (found == later.end()) continue;
        const Vec2 step = now.box.minimum_image(next.position[found->second] - now.position[i]);
        motion.velocity[i] = {step.x / diameter / seconds, step.y / diameter / seconds, 0};
    }
}

}  // namespace

double GrainMotion::lateral_speed() const {
    if (velocity.empty()) return 0;
    double sum = 0;
    for (const Vec3& v : velocity) sum += v.x * v.x + v.y * v.y;
    return std::sqrt(sum / static_cast<double>(velocity.size()));
}

double seconds_per_unit(const TrajectoryInfo& info, const RenderOptions& options) {
    switch (info.time_unit) {
        case TimeUnit::second:
            return 1;
        case TimeUnit::sqrt_a_over_g:
            return std::sqrt(options.view.sphere_mm * 1e-3 / standard_gravity);
        case TimeUnit::frame:
            break;
    }
    return options.exposure.frame_rate ? 1 / *options.exposure.frame_rate : 0;
}

GrainMotion grain_motion(const Snapshot& snapshot, const Snapshot* next, const TrajectoryInfo& info,
                         double cell_height, double seconds_per_unit, double sphere_mm) {
    GrainMotion motion;
    motion.has_heights = !snapshot.z.empty() || !snapshot.layer.empty();
    motion.centre.reserve(snapshot.size());
    for (std::size_t i = 0; i < snapshot.size(); ++i) {
        const Vec2 p = snapshot.position[i] * (1 / info.diameter);
        motion.centre.push_back({p.x, p.y, height_of(snapshot, i, info.diameter, cell_height)});
    }
    if (!(seconds_per_unit > 0)) return motion;
    if (!snapshot.velocity.empty()) {
        const double factor = 1 / (info.diameter * seconds_per_unit);
        motion.velocity.reserve(snapshot.size());
        for (const Vec3& v : snapshot.velocity) motion.velocity.push_back(v * factor);
        if (!snapshot.z.empty()) motion.gravity = standard_gravity / (sphere_mm * 1e-3);
    } else if (next != nullptr) {
        add_chords(snapshot, *next, info.diameter, (next->time - snapshot.time) * seconds_per_unit,
                   motion);
    }
    return motion;
}

}  // namespace grainfield::simulate
