#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/snapshot.h"
#include "core/trajectory.h"
#include "core/vec3.h"
#include "simulate/render/render_options.h"

namespace grainfield::simulate {

/// A snapshot among those around it, in order of time.
struct SnapshotSeries {
    std::span<const Snapshot> all;
    std::size_t now = 0;  ///< the one in the middle of the exposure
    const Snapshot& snapshot() const { return all[now]; }
};

/// Flights from one snapshot to the next, one a grain.
struct FlightTally {
    std::int64_t free = 0;     ///< without a collision
    std::int64_t turned = 0;   ///< with one, which was reconstructed
    std::int64_t several = 0;  ///< with more, of which no trace is left
    void add(const FlightTally& other);
};

/// The spheres of a snapshot in units of a, and how they move about that instant (grain_motion).
struct GrainMotion {
    std::vector<Vec3> centre;    ///< [a]
    std::vector<Vec3> velocity;  ///< [a/s]; empty: at rest
    double gravity = 0;          ///< downward acceleration [a/s²]
    bool has_heights = false;    ///< from z or layers

    /// Between two snapshots; times relative to the snapshot `now` [s], lengths in a.
    struct Leg {
        double begin = 0, end = 0;
        std::vector<Vec3> from, velocity_after;  ///< at the first snapshot
        std::vector<Vec3> to, velocity_before;   ///< at the second one
        std::vector<double> turn;                ///< when the one flight becomes the other
    };
    std::vector<Leg> legs;  ///< one after the other; empty: flights from `centre`
    FlightTally flights;

    Vec3 at(std::size_t i, double seconds) const;
    /// Root mean square speed in the plane [a/s].
    double lateral_speed() const;
};

/// Seconds per time unit of a trajectory of spheres of `sphere_mm`: sqrt(a/g) in MD; the frame
/// interval where the unit is "frame" and `frame_rate` is given; 0 if unknown.
double seconds_per_unit(const TrajectoryInfo& info, const RenderOptions& options);

/// How spheres move about the snapshot `series.now`. Where velocities are known, between two
/// snapshots Δ apart a sphere leaves the first and reaches the second on parabolas
///
///   F(τ) = r₀ + v₀ τ − g τ²/2 ẑ,   B(τ) = r₁ + v₁ (τ − Δ) − g (τ − Δ)²/2 ẑ,
///
/// whose difference is linear in τ: zero throughout without a collision; with one it is zero at the
/// collision, wherever that was (pair, plate or wall), and least squares find it. If nothing is
/// left of the difference there (1e-4 a), the flight is followed exactly. With several collisions F
/// holds for the first half and B for the second: exact up to the first and from the last one on.
/// Snapshots closer in time than the collisions of a grain resolve all.
///
/// Without velocities: chords between the snapshots; with one snapshot: its own parabolas; grains
/// that are not in another snapshot go on as if undisturbed. Heights: Renderer's docstring;
/// `cell_height` in a.
GrainMotion grain_motion(const SnapshotSeries& series, const TrajectoryInfo& info,
                         double cell_height, double seconds_per_unit, double sphere_mm);

}  // namespace grainfield::simulate
