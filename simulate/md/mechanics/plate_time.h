#pragma once

#include <cmath>

#include "simulate/md/mechanics/flight.h"
#include "simulate/md/mechanics/sine.h"
#include "simulate/md/state/md_system.h"

namespace grainfield::simulate {

enum class Plates { none, at_rest, vibrating };

/// When a grain in free flight meets the low plate, z − ½ = A sin ωt, or the high one,
/// z + ½ = A sin ωt + L_z. Times count from an instant at which the plates pass z = 0 upwards.
///
/// Vibrating plates: with the gap f ≥ 0 and a bound M ≥ −f'' for all times the step
///
///   τ += (f' + sqrt(f'² + 2 M f)) / M
///
/// ends before or at the next root, whatever the plate does. No root can be skipped. From f = 0
/// while receding it cannot find the same root again. M = g + Aω² below, Aω² − g above (at least
/// M_min, as any larger M is a bound too). Converges quadratically on transversal roots; iteration
/// ends at a gap of `tolerance` or once the limit is passed, which is typical: 1.6 steps on
/// average.
struct PlateSolver {
    double gravity = 1;
    double amplitude = 0;
    double omega = 0;
    double height = 1;  ///< L_z
    double tolerance = 1e-15;
    double speed_bound = 0;     ///< Aω
    double low_curvature = 1;   ///< M of the low plate
    double high_curvature = 1;  ///< M of the high plate
    double low_rebound = 0;     ///< least speed off the low plate, see least_rebound()
    double high_rebound = 0;    ///< least speed off the high plate

    explicit PlateSolver(const MdSystem& system);

    struct Hit {
        double time = never;
        bool high = false;
    };

    /// The first plate met before `limit`. Pure: depends on the grain's state alone.
    template <Plates plates, bool has_gravity>
    Hit first_hit(const Grain& grain, double limit) const {
        if constexpr (plates == Plates::vibrating) return vibrating_hit(grain, limit);
        return resting_hit<has_gravity>(grain, limit);
    }

    /// Velocity of both plates at time t.
    double plate_velocity(double t) const { return speed_bound * sine_cosine(omega * t).cosine; }

    struct Motion {
        double shift = 0;  ///< A sin ωt [a]
        double velocity = 0;
    };
    Motion plate_motion(double t) const {
        const SineCosine plate = sine_cosine(omega * t);
        return {amplitude * plate.sine, speed_bound * plate.cosine};
    }

    /// With the TC model, the least speed at which a grain leaves a plate, v = ½ M t_c; 0 without.
    ///
    /// A grain at rest on a plate (gap 0, rate 0) has no next contact that an event could be. It
    /// hops instead, for a contact time or longer and no higher than v²/2(g + z̈), as long as the
    /// plate carries it, and flies off when the plate's acceleration falls below −g.
    double least_rebound(bool is_high) const { return is_high ? high_rebound : low_rebound; }

 private:
    /// Longest τ that surely ends before contact for gap f, its rate and curvature bound m.
    static double safe_step(double f, double rate, double m) {
        const double root = std::sqrt(rate * rate + 2 * m * f);
        return rate < 0 ? 2 * f / (root - rate) : (rate + root) / m;
    }

    Hit vibrating_hit(const Grain& grain, double limit) const {
        const double low_centre = grain.r.z - 0.5;
        const double high_centre = height - 0.5 - grain.r.z;
        const double span = limit - grain.t;
        // Without knowing the phase: the plates cannot be nearer or faster than this.
        const double low_least = low_centre - amplitude;
        const double high_least = high_centre - amplitude;
        const bool low_far =
            low_least > 0 && safe_step(low_least, grain.v.z - speed_bound, low_curvature) > span;
        const bool high_far = high_least > 0 && safe_step(high_least, -speed_bound - grain.v.z,
                                                          high_curvature) > span;
        if (low_far && high_far) return {};
        const SineCosine plate = sine_cosine(omega * grain.t);
        const double shift = amplitude * plate.sine;
        const double rate = grain.v.z - speed_bound * plate.cosine;
        Hit hit;
        if (!low_far) {
            hit.time = vibrating_root(grain, limit, low_centre - shift, rate, +1, low_curvature);
            if (hit.time < limit) limit = hit.time;
        }
        if (!high_far) {
            const double t =
                vibrating_root(grain, limit, high_centre + shift, -rate, -1, high_curvature);
            if (t < limit) hit = {t, true};
        }
        return hit;
    }

    /// `side` +1: gap = z − ½ − A sin ωt; −1: L_z + A sin ωt − z − ½.
    double vibrating_root(const Grain& grain, double limit, double gap, double rate, double side,
                          double curvature) const {
        if (gap <= 0 && rate < 0) return grain.t < limit ? grain.t : never;
        const double offset = side > 0 ? -0.5 : height - 0.5;
        double tau = 0;
        for (int i = 0; i < 1000; ++i) {
            const double step = safe_step(gap > 0 ? gap : 0, rate, curvature);
            tau += step;
            const double t = grain.t + tau;
            if (!(t < limit)) return never;
            const SineCosine plate = sine_cosine(omega * t);
            const double z = grain.r.z + (grain.v.z * tau - 0.5 * gravity * tau * tau);
            gap = side * (z - amplitude * plate.sine) + offset;
            rate = side * (grain.v.z - gravity * tau - speed_bound * plate.cosine);
            if (gap <= tolerance && (rate < 0 || step < 1e-14)) return t;
        }
        return grain.t + tau;
    }

    template <bool has_gravity>
    Hit resting_hit(const Grain& grain, double limit) const {
        const double low = grain.r.z - 0.5;
        const double high = height - 0.5 - grain.r.z;
        const double v = grain.v.z;
        double low_time = never;
        double high_time = never;
        if (low <= 0) {
            if (v < 0) {
                low_time = 0;
            } else if (has_gravity) {
                low_time = 2 * v / gravity;
            }
        } else if (has_gravity) {
            const double root = std::sqrt(v * v + 2 * gravity * low);
            low_time = v < 0 ? 2 * low / (root - v) : (v + root) / gravity;
        } else if (v < 0) {
            low_time = low / -v;
        }
        if (high <= 0) {
            if (v > 0) high_time = 0;
        } else if (v > 0) {
            const double d = has_gravity ? v * v - 2 * gravity * high : v * v;
            if (d >= 0) high_time = 2 * high / (v + std::sqrt(d));
        }
        const bool is_high = high_time < low_time;
        const double t = grain.t + (is_high ? high_time : low_time);
        return t < limit ? Hit{t, is_high} : Hit{};
    }
};

}  // namespace grainfield::simulate
