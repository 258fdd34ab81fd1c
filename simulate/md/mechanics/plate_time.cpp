#include "simulate/md/mechanics/plate_time.h"

#include <algorithm>

namespace grainfield::simulate {

PlateSolver::PlateSolver(const MdSystem& system)
    : gravity(system.gravity),
      amplitude(system.is_vibrating() ? system.amplitude : 0),
      omega(system.is_vibrating() ? system.angular_frequency : 0),
      height(system.length.z),
      tolerance(system.plate_tolerance),
      speed_bound(amplitude * omega) {
    const double acceleration = speed_bound * omega;
    const double least = std::max(1e-3 * (gravity + acceleration), 1e-12);
    low_curvature = std::max(gravity + acceleration, least);
    high_curvature = std::max(acceleration - gravity, least);
    low_rebound = 0.5 * low_curvature * system.contact_time;
    high_rebound = 0.5 * high_curvature * system.contact_time;
}

}  // namespace grainfield::simulate
