#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/vec3.h"

namespace grainfield::simulate {

constexpr double never = std::numeric_limits<double>::infinity();

/// One grain between two of its events: where it was at its own last event, one cache line.
struct alignas(64) Grain {
    Vec3 r;                    ///< at time t [a]
    Vec3 v;                    ///< at time t [sqrt(g a)]
    double t = 0;              ///< of the last event, relative to the window's origin [sqrt(a/g)]
    std::int32_t next = -1;    ///< in the list of its cell
    std::uint32_t events = 0;  ///< so far in this window; tells outdated predictions
};

/// r(t) = r + v τ − ½ g τ² ẑ, v(t) = v − g τ ẑ, exact in free flight.
inline void fly(Vec3& r, Vec3& v, double tau, double gravity) {
    r.x += v.x * tau;
    r.y += v.y * tau;
    r.z += v.z * tau - 0.5 * gravity * tau * tau;
    v.z -= gravity * tau;
}

/// The time at which grains 1 and 2 + shift touch if nothing else happens to them, or `never` if it
/// is not before `limit`.
///
///   |r + v τ|² = 1:  τ = f / (−b + sqrt(b² − v² f)),  f = r² − 1, b = r·v
///
/// from the later of the two grains' own times. This form does not cancel; f ≤ 0 while approaching
/// means now, receding means never, so that rounding neither misses a contact nor finds it twice.
/// Gravity falls out of r and v. The result is the same, bit by bit, with the grains exchanged and
/// at whatever time it is computed, which makes the trajectory independent of the order of the
/// work. The engine computes it for several grains at a time (first_contact.h); this plain form is
/// what its bits are compared with.
template <bool has_gravity>
inline double pair_time(const Grain& g1, const Grain& g2, const Vec3& shift, double gravity,
                        double limit) {
    const double start = std::max(g1.t, g2.t);
    const double tau1 = start - g1.t;
    const double tau2 = start - g2.t;
    Vec3 v = g2.v - g1.v;
    Vec3 r{(g2.r.x + g2.v.x * tau2) - (g1.r.x + g1.v.x * tau1) + shift.x,
           (g2.r.y + g2.v.y * tau2) - (g1.r.y + g1.v.y * tau1) + shift.y, 0};
    if constexpr (has_gravity) {
        r.z = (g2.r.z + g2.v.z * tau2 - 0.5 * gravity * tau2 * tau2) -
              (g1.r.z + g1.v.z * tau1 - 0.5 * gravity * tau1 * tau1) + shift.z;
        v.z = (g2.v.z - gravity * tau2) - (g1.v.z - gravity * tau1);
    } else {
        r.z = (g2.r.z + g2.v.z * tau2) - (g1.r.z + g1.v.z * tau1) + shift.z;
    }
    const double b = dot(r, v);
    const double f = squared_norm(r) - 1;
    if (f + 2 * b * (limit - start) > 0 || !(b < 0)) return never;
    if (f <= 0) return start;
    const double discriminant = b * b - squared_norm(v) * f;
    if (discriminant < 0) return never;
    return start + f / (std::sqrt(discriminant) - b);
}

}  // namespace grainfield::simulate
