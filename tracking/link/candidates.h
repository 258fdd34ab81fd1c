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

/// The points of a frame, or of the tracks, in square cells.
class TrackGrid {
 public:
    /// `range`: of the queries [px]. Points must be finite.
    TrackGrid(const std::vector<Vec2>& points, double range);

    /// Calls action(index) for all points within `range` of p, and for some farther away.
    template <class Action>
    void near(Vec2 p, Action&& action) const {
        if (order_.empty()) return;
        const Block b = block(p);
        for (std::int64_t y = b.first_row; y <= b.last_row; ++y) {
            // The cells of a row stand side by side.
            const auto begin = first_[static_cast<std::size_t>(y * columns_ + b.first_column)];
            const auto end = first_[static_cast<std::size_t>(y * columns_ + b.last_column + 1)];
            for (std::uint32_t i = begin; i < end; ++i) action(order_[i]);
        }
    }

 private:
    struct Block {
        std::int64_t first_row, last_row, first_column, last_column;
    };
    Block block(Vec2 p) const;
    std::size_t cell_of(Vec2 p) const;

    Vec2 low_;
    double size_ = 1;
    std::int64_t columns_ = 0, rows_ = 0;
    std::vector<std::uint32_t> first_, order_;
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
