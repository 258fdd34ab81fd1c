#include "simulate/render/motion/grain_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "core/lab_units.h"

namespace grainfield::simulate {

namespace {

constexpr double same_place = 1e-4;  // [a]: a hundredth of the noise of a position
constexpr std::size_t nowhere = std::numeric_limits<std::size_t>::max();

double height_of(const Snapshot& s, std::size_t i, double diameter, double cell_height) {
    if (!s.z.empty()) return s.z[i] / diameter;
    if (!s.layer.empty() && s.layer[i] == Layer::top) return cell_height - 0.5;
    return 0.5;
}

Vec3 fly(Vec3 from, Vec3 velocity, double gravity, double seconds) {
    return from + velocity * seconds + Vec3{0, 0, -0.5 * gravity * seconds * seconds};
}

/// Where each grain of `now` stands in `other`; empty if it has the same order.
std::vector<std::size_t> places_in(const Snapshot& other, const Snapshot& now) {
    if (other.id == now.id) return {};
    std::unordered_map<std::int64_t, std::size_t> place;
    for (std::size_t i = 0; i < other.id.size(); ++i) place.emplace(other.id[i], i);
    std::vector<std::size_t> places;
    for (const std::int64_t id : now.id) {
        const auto found = place.find(id);
        places.push_back(found == place.end() ? nowhere : found->second);
    }
    return places;
}

/// Makes the legs of one series, outwards from the snapshot in the middle.
class LegMaker {
 public:
    LegMaker(const SnapshotSeries& series, const TrajectoryInfo& info, double cell_height,
             double seconds_per_unit, GrainMotion& motion)
        : series_(series),
          diameter_(info.diameter),
          height_(cell_height),
          unit_(seconds_per_unit),
          motion_(motion) {
        for (const Snapshot& s : series.all) {
            has_velocities_ = has_velocities_ && s.velocity.size() == s.size() && s.size() > 0;
            places_.push_back(places_in(s, series.snapshot()));
        }
    }

    void make() {
        if (!has_velocities_) motion_.gravity = 0;  // chords
        const std::size_t n = series_.all.size();
        motion_.legs.resize(n - 1);
        std::vector<Vec3> reached = motion_.centre;
        for (std::size_t k = series_.now; k + 1 < n; ++k) reached = leg(k, true, reached);
        reached = motion_.centre;
        for (std::size_t k = series_.now; k-- > 0;) reached = leg(k, false, reached);
    }

 private:
    double time_of(std::size_t k) const {
        return (series_.all[k].time - series_.snapshot().time) * unit_;
    }
    std::size_t place(std::size_t k, std::size_t grain) const {
        return places_[k].empty() ? grain : places_[k][grain];
    }
    Vec3 step(std::size_t k, std::size_t a, std::size_t b) const {
        const Snapshot& first = series_.all[k];
        const Snapshot& second = series_.all[k + 1];
        const Vec2 d = first.box.minimum_image(second.position[b] - first.position[a]);
        return {d.x / diameter_, d.y / diameter_,
                height_of(second, b, diameter_, height_) - height_of(first, a, diameter_, height_)};
    }
    Vec3 velocity(std::size_t k, std::size_t i) const {
        return series_.all[k].velocity[i] * (1 / (diameter_ * unit_));
    }

    // Leg k, known where it begins (onwards) or ends; returns the other end.
    std::vector<Vec3> leg(std::size_t k, bool onwards, const std::vector<Vec3>& known) {
        GrainMotion::Leg& leg = motion_.legs[k];
        leg.begin = time_of(k);
        leg.end = time_of(k + 1);
        const std::size_t count = known.size();
        leg.from = leg.to = known;
        leg.velocity_after.resize(count);
        leg.velocity_before.resize(count);
        leg.turn.assign(count, 0.5 * (leg.begin + leg.end));
        const double length = leg.end - leg.begin;
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t a = place(k, i);
            const std::size_t b = place(k + 1, i);
            if (a == nowhere || b == nowhere || !(length > 0)) {
                undisturbed(leg, i, onwards, onwards ? a : b, onwards ? k : k + 1);
                continue;
            }
            const Vec3 way = step(k, a, b);
            (onwards ? leg.to : leg.from)[i] = onwards ? known[i] + way : known[i] - way;
            leg.velocity_after[i] = has_velocities_ ? velocity(k, a) : way * (1 / length);
            leg.velocity_before[i] = has_velocities_ ? velocity(k + 1, b) : leg.velocity_after[i];
            if (has_velocities_) find_turn(leg, i);
        }
        return onwards ? leg.to : leg.from;
    }

    void undisturbed(GrainMotion::Leg& leg, std::size_t i, bool onwards, std::size_t there,
                     std::size_t k) const {
        const Vec3 v = has_velocities_ && there != nowhere ? velocity(k, there) : Vec3{};
        const double length = leg.end - leg.begin;
        const Vec3 fall{0, 0, -motion_.gravity * length};
        const bool flies = has_velocities_ && there != nowhere;
        leg.velocity_after[i] = onwards || !flies ? v : v - fall;
        leg.velocity_before[i] = onwards && flies ? v + fall : v;
        if (!flies) return;
        if (onwards) {
            leg.to[i] = fly(leg.from[i], v, motion_.gravity, length);
        } else {
            leg.from[i] = fly(leg.to[i], v, motion_.gravity, -length);
        }
    }

    void find_turn(GrainMotion::Leg& leg, std::size_t i) {
        const double length = leg.end - leg.begin;
        const double g = motion_.gravity;
        const Vec3 start = leg.from[i] - leg.to[i] + leg.velocity_before[i] * length +
                           Vec3{0, 0, 0.5 * g * length * length};
        const Vec3 slope = leg.velocity_after[i] - leg.velocity_before[i] - Vec3{0, 0, g * length};
        if (norm(start) <= same_place && norm(start + slope * length) <= same_place) {
            ++motion_.flights.free;
            return;
        }
        const double square = squared_norm(slope);
        const double at =
            square > 0 ? std::clamp(-dot(start, slope) / square, 0.0, length) : 0.5 * length;
        if (norm(start + slope * at) <= same_place) {
            ++motion_.flights.turned;
            leg.turn[i] = leg.begin + at;
        } else {
            ++motion_.flights.several;
        }
    }

    const SnapshotSeries& series_;
    double diameter_;
    double height_;
    double unit_;
    GrainMotion& motion_;
    bool has_velocities_ = true;
    std::vector<std::vector<std::size_t>> places_;
};

}  // namespace

void FlightTally::add(const FlightTally& other) {
    free += other.free;
    turned += other.turned;
    several += other.several;
}

Vec3 GrainMotion::at(std::size_t i, double seconds) const {
    if (legs.empty()) {
        return velocity.empty() ? centre[i] : fly(centre[i], velocity[i], gravity, seconds);
    }
    std::size_t k = 0;
    while (k + 1 < legs.size() && seconds > legs[k].end) ++k;
    const Leg& leg = legs[k];
    return seconds < leg.turn[i]
               ? fly(leg.from[i], leg.velocity_after[i], gravity, seconds - leg.begin)
               : fly(leg.to[i], leg.velocity_before[i], gravity, seconds - leg.end);
}

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
            return seconds_of_time_unit(options.view.sphere_mm);
        case TimeUnit::frame:
            break;
    }
    return options.exposure.frame_rate ? 1 / *options.exposure.frame_rate : 0;
}

GrainMotion grain_motion(const SnapshotSeries& series, const TrajectoryInfo& info,
                         double cell_height, double seconds_per_unit, double sphere_mm) {
    const Snapshot& snapshot = series.snapshot();
    GrainMotion motion;
    motion.has_heights = !snapshot.z.empty() || !snapshot.layer.empty();
    motion.centre.reserve(snapshot.size());
    for (std::size_t i = 0; i < snapshot.size(); ++i) {
        const Vec2 p = snapshot.position[i] * (1 / info.diameter);
        motion.centre.push_back({p.x, p.y, height_of(snapshot, i, info.diameter, cell_height)});
    }
    if (!(seconds_per_unit > 0) || snapshot.size() == 0) return motion;
    if (!snapshot.velocity.empty()) {
        const double factor = 1 / (info.diameter * seconds_per_unit);
        motion.velocity.reserve(snapshot.size());
        for (const Vec3& v : snapshot.velocity) motion.velocity.push_back(v * factor);
        if (!snapshot.z.empty()) motion.gravity = standard_gravity / (sphere_mm * 1e-3);
    }
    if (series.all.size() < 2 || snapshot.id.empty()) return motion;
    LegMaker(series, info, cell_height, seconds_per_unit, motion).make();
    if (!motion.velocity.empty()) return motion;
    const bool last = series.now + 1 == series.all.size();
    const GrainMotion::Leg& leg = motion.legs[last ? series.now - 1 : series.now];
    motion.velocity = last ? leg.velocity_before : leg.velocity_after;
    for (Vec3& v : motion.velocity) v.z = motion.has_heights ? v.z : 0;
    return motion;
}

}  // namespace grainfield::simulate
