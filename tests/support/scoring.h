#pragma once

#include <vector>

#include "core/vec2.h"

namespace grainfield::testing {

/// How well found positions meet the truth: one-to-one, nearest pairs first, within a gate.
struct Score {
    int matched = 0;
    int missed = 0;            ///< true positions without a partner (FN)
    int spurious = 0;          ///< found positions without a partner (FP)
    double rms = 0;            ///< per axis, of the matched [px]
    Vec2 bias;                 ///< mean of found − true [px]
    std::vector<int> partner;  ///< per true position the index found, −1 if missed

    double recall() const;
    double precision() const;
};

/// Scores within the frame less a margin: true positions outside it may be matched but count
/// neither as missed nor in the errors; found ones outside it are never spurious.
Score score(const std::vector<Vec2>& found, const std::vector<Vec2>& truth, double gate, int width,
            int height, double margin);

}  // namespace grainfield::testing
