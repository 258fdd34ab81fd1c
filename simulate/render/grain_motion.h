#pragma once

#include <cstdint>
#include <vector>

#include "core/snapshot.h"
#include "core/trajectory.h"
#include "core/vec3.h"
#include "simulate/render/render_options.h"

namespace grainfield::simulate {

/// The spheres of a snapshot in units of a, and how they move about that instant.
struct GrainMotion {
    std::vector<Vec3> centre;    ///< [a]
    std::vector<Vec3> velocity;  ///< [a/s]; empty: at rest
    double gravity = 0;          ///< downward acceleration [a/s²]
    bool has_heights = false;    ///< from z or layers

    Vec3 at(std::size_t i, double seconds) const {
        if (velocity.empty()) return centre[i];
        const Vec3 fall{0, 0, -0.5 * gravity * seconds * seconds};
        return centre[i] + velocity[i] * seconds + fall;
    }
    /// Root mean square speed in the plane [a/s].
    double lateral_speed() const;
};

/// Seconds per time unit of a trajectory of spheres of `sphere_mm`: sqrt(a/g) in MD; the frame
/// interval where the unit is "frame" and `frame_rate` is given; 0 if unknown.
double seconds_per_unit(const TrajectoryInfo& info, const RenderOptions& options);

/// Flights from velocities, else chords to the spheres of the same id in `next` (may be null), else
/// at rest. Heights: Renderer's docstring; `cell_height` in a.
GrainMotion grain_motion(const Snapshot& snapshot, const Snapshot* next, const TrajectoryInfo& info,
                         double cell_height, double seconds_per_unit, double sphere_mm);

}  // namespace grainfield::simulate
