#pragma once

#include <vector>

#include "core/vec2.h"

namespace grainfield::tracking {

/// Pairs found positions with true ones: one-to-one, the nearest pairs first, none farther apart
/// than `gate` [px]. Per true position the index of the one found, −1 if there is none.
/// Deterministic: equal distances go to the smaller indices. Cost O(N log N) at bounded density.
std::vector<int> match_positions(const std::vector<Vec2>& found, const std::vector<Vec2>& truth,
                                 double gate);

/// How well the positions found in one frame meet the truth.
struct PositionScore {
    int matched = 0;           ///< TP
    int missed = 0;            ///< true positions without a partner (FN)
    int spurious = 0;          ///< found positions without a partner (FP)
    double rms = 0;            ///< per axis, of the matched [px]
    Vec2 bias;                 ///< mean of found − true [px]
    std::vector<int> partner;  ///< per true position the index found, −1 if missed

    double recall() const;     ///< TP/(TP + FN); 1 where nothing was to be found
    double precision() const;  ///< TP/(TP + FP); 1 where nothing was found
};

/// Scores within the frame less a margin: true positions outside it may be matched but count
/// neither as missed nor in the errors; found ones outside it are never spurious.
PositionScore score_positions(const std::vector<Vec2>& found, const std::vector<Vec2>& truth,
                              double gate, int width, int height, double margin);

}  // namespace grainfield::tracking
