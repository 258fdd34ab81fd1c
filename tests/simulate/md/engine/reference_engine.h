#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "simulate/md/mechanics/collision_rule.h"
#include "simulate/md/mechanics/flight.h"
#include "simulate/md/mechanics/plate_time.h"
#include "simulate/md/state/grain_state.h"

namespace grainfield::simulate {

/// Event-driven dynamics without cells, calendar, tiles or policies: before each event every pair,
/// image, plate and wall gives its time, and the earliest happens. O(N²) an event; the
/// oracle of EventEngine.
class ReferenceEngine {
 public:
    ReferenceEngine(const MdSystem& system, const GrainState& state, double end)
        : system_(system), solver_(system), end_(end), spin_(state.spin) {
        grain_.resize(state.size());
        for (std::size_t i = 0; i < state.size(); ++i) {
            grain_[i].r = state.position[i];
            grain_[i].v = state.velocity[i];
        }
    }

    /// Executes the next event before `end`; false if there is none.
    bool step() {
        Event next;
        for (std::size_t i = 0; i < grain_.size(); ++i) {
            consider_pairs(i, next);
            consider_obstacles(i, next);
        }
        if (next.time >= end_) return false;
        apply(next);
        time_ = next.time;
        return true;
    }

    std::int64_t collisions() const { return collisions_; }
    double time() const { return time_; }  ///< of the last event
    Vec3 position(std::size_t i, double t) const {
        Vec3 r = grain_[i].r;
        Vec3 v = grain_[i].v;
        fly(r, v, t - grain_[i].t, system_.gravity);
        return r;
    }
    Vec3 velocity(std::size_t i, double t) const {
        Vec3 r = grain_[i].r;
        Vec3 v = grain_[i].v;
        fly(r, v, t - grain_[i].t, system_.gravity);
        return v;
    }
    const Vec3& spin(std::size_t i) const { return spin_[i]; }

 private:
    enum class Kind { none, pair, low, high, wall, wrap };
    struct Event {
        double time = never;
        Kind kind = Kind::none;
        std::size_t i = 0;
        std::size_t j = 0;
        Vec3 normal;  ///< of walls
        int axis = 0;
        bool up = false;
    };

    static double& component(Vec3& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

    bool is_periodic(int axis) const {
        return axis == 0 ? !system_.walls_x
                         : (axis == 1 ? !system_.walls_y : system_.vertical == Vertical::periodic);
    }

    void consider_pairs(std::size_t i, Event& next) const {
        const Vec3 l = system_.length;
        const auto reach = [this](int axis) { return is_periodic(axis) ? 1 : 0; };
        for (std::size_t j = i + 1; j < grain_.size(); ++j) {
            for (int z = -reach(2); z <= reach(2); ++z) {
                for (int y = -reach(1); y <= reach(1); ++y) {
                    for (int x = -reach(0); x <= reach(0); ++x) {
                        const Vec3 shift{x * l.x, y * l.y, z * l.z};
                        const double t =
                            system_.gravity > 0
                                ? pair_time<true>(grain_[i], grain_[j], shift, system_.gravity,
                                                  end_)
                                : pair_time<false>(grain_[i], grain_[j], shift, 0, end_);
                        if (t < next.time) next = {t, Kind::pair, i, j, {}, 0, false};
                    }
                }
            }
        }
    }

    void consider_obstacles(std::size_t i, Event& next) {
        Grain g = grain_[i];
        for (int axis = 0; axis < 3; ++axis) {
            const double x = component(g.r, axis);
            const double v = component(g.v, axis);
            const double length = component(system_.length, axis);
            if (is_periodic(axis)) {
                if (v == 0) continue;
                const double t = g.t + std::max(((v > 0 ? length : 0) - x) / v, 0.0);
                if (t < next.time) next = {t, Kind::wrap, i, i, {}, axis, v > 0};
            } else if (axis < 2 && v != 0) {
                const double distance = v < 0 ? x - 0.5 : length - 0.5 - x;
                const double t = g.t + (distance > 0 ? distance / std::abs(v) : 0);
                Vec3 n;
                component(n, axis) = v < 0 ? 1 : -1;
                if (t < next.time) next = {t, Kind::wall, i, i, n, axis, false};
            }
        }
        if (system_.vertical == Vertical::periodic) return;
        PlateSolver::Hit hit;
        if (system_.is_vibrating()) {
            hit = solver_.first_hit<Plates::vibrating, true>(g, end_);
        } else if (system_.gravity > 0) {
            hit = solver_.first_hit<Plates::at_rest, true>(g, end_);
        } else {
            hit = solver_.first_hit<Plates::at_rest, false>(g, end_);
        }
        if (hit.time < next.time) {
            next = {hit.time, hit.high ? Kind::high : Kind::low, i, i, {}, 2, false};
        }
    }

    void apply(const Event& e) {
        Grain& g1 = grain_[e.i];
        fly(g1.r, g1.v, e.time - g1.t, system_.gravity);
        g1.t = e.time;
        if (e.kind == Kind::wrap) {
            component(g1.r, e.axis) = e.up ? 0 : component(system_.length, e.axis);
            return;
        }
        ++collisions_;
        if (e.kind != Kind::pair) {
            const Vec3 n =
                e.kind == Kind::wall ? e.normal : Vec3{0, 0, e.kind == Kind::high ? -1.0 : 1.0};
            Vec3 u = g1.v;
            if (system_.is_vibrating()) u.z -= solver_.plate_velocity(e.time);
            u -= 0.5 * cross(spin_[e.i], n);
            const Impulse impulse =
                impulse_of<Tangential::coulomb>(n, u, 1, system_.plate.restitution, system_.plate);
            if (!(impulse.normal > 0)) return;
            g1.v += impulse.j;
            spin_[e.i] += spin_change(n, impulse.j);
            return;
        }
        Grain& g2 = grain_[e.j];
        fly(g2.r, g2.v, e.time - g2.t, system_.gravity);
        g2.t = e.time;
        Vec3 n = g1.r - g2.r;
        for (int axis = 0; axis < 3; ++axis) {
            const double length = component(system_.length, axis);
            double& d = component(n, axis);
            if (!is_periodic(axis)) continue;
            if (d > 0.5 * length) {
                d -= length;
            } else if (d < -0.5 * length) {
                d += length;
            }
        }
        n = (1 / std::sqrt(squared_norm(n))) * n;
        const Vec3 u = contact_velocity(g1.v, g2.v, spin_[e.i], spin_[e.j], n);
        const Impulse impulse =
            impulse_of<Tangential::coulomb>(n, u, 0.5, system_.grain.restitution, system_.grain);
        if (!(impulse.normal > 0)) return;
        g1.v += impulse.j;
        g2.v -= impulse.j;
        const Vec3 change = spin_change(n, impulse.j);
        spin_[e.i] += change;
        spin_[e.j] += change;
    }

    MdSystem system_;
    PlateSolver solver_;
    double end_;
    std::vector<Grain> grain_;
    std::vector<Vec3> spin_;
    std::int64_t collisions_ = 0;
    double time_ = 0;
};

}  // namespace grainfield::simulate
