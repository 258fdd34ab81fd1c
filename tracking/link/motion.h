#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/vec2.h"

namespace grainfield::tracking {

/// Where a track is looked for in the next frame.
enum class Predictor {
    none,              ///< where it was
    nearest_velocity,  ///< moved on with its own last velocity, a new track with its neighbour's
    drift,             ///< moved on with all others
};

/// A sphere that is followed.
struct Track {
    std::int64_t id = 0;
    std::int64_t frame = 0;        ///< last seen
    Vec2 position;                 ///< there [px]
    Vec2 error;                    ///< standard error per axis there [px]
    std::optional<Vec2> velocity;  ///< from the last two times it was seen [px/frame]
};

/// Predicted positions of all tracks in `frame`: position + velocity · (frame − last seen).
///
/// For Predictor::nearest_velocity a track without a velocity takes that of the nearest track
/// (within `range`) that has one, else `drift`. O(tracks) at fixed density.
std::vector<Vec2> predict(const std::vector<Track>& tracks, std::int64_t frame, Predictor predictor,
                          Vec2 drift, double range);

/// The median of each component (of an even number: the upper one). Up to half of the entries may
/// be wrong links or spheres that go elsewhere without any influence beyond their rank. O(N).
Vec2 median(std::vector<Vec2> values);

/// A step whose length was seen: |step|² and the squared errors of both ends, per axis [px²].
struct SeenStep {
    double squared = 0;
    double squared_errors = 0;  ///< e_t² + e_p²
};

/// Variance s² of the motion per axis [px²], errors taken off: |step|²/(s² + e²) is exponential, so
/// its median is 2 ln 2; s² is where that holds (bisection to 1e-9 of the largest step), 0 if it
/// holds nowhere. Of many steps 1,000 spread evenly are used.
double motion_variance(const std::vector<SeenStep>& steps);

}  // namespace grainfield::tracking
