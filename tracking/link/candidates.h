#pragma once

#include <cstdint>
#include <vector>

#include "core/vec2.h"
#include "tracking/link/assignment.h"

namespace grainfield::tracking {

/// What a step costs when positions are known to different precision.
///
/// Crocker and Grier maximise Π exp(−d²/2v), v the variance of a step per axis [px²]. Between a
/// track and a particle with standard errors e_t, e_p it is v = s² + e_t² + e_p², s² that of the
/// motion alone. Scaled by the typical v̄ = s² + 2 ē², ē the RMS error,
///
///     cost = v̄ (dx²/v_x + dy²/v_y) + v̄ ln(v_x v_y / v̄²)   [px²],
///
/// which is d² when all errors are equal. Without `motion` every step costs d² (`crocker1996`).
struct StepCost {
    double motion = 0;         ///< s² [px²]; 0: plain d²
    double squared_error = 0;  ///< ē² [px²]

    double operator()(Vec2 step, Vec2 track_error, Vec2 particle_error) const;
};

/// Places with standard errors per axis; no errors: all alike.
struct Places {
    const std::vector<Vec2>& position;
    const std::vector<Vec2>& error;

    Vec2 error_of(std::size_t i) const { return error.empty() ? Vec2{} : error[i]; }
};

/// The pairs (row: track, column: particle) that may be one sphere, sorted by track.
struct Candidates {
    std::vector<AssignmentPair> pairs;
    std::int64_t crowded_tracks = 0;  ///< with more particles in reach than are kept
};

/// All pairs not farther apart than `range` [px] whose cost does not exceed range²; of the
/// particles in reach of one track at most the 32 cheapest. O(tracks) at fixed density.
Candidates find_candidates(const Places& tracks, const Places& particles, double range,
                           const StepCost& cost);

}  // namespace grainfield::tracking
