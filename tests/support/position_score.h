#pragma once

#include <vector>

#include "tracking/score/detection_scores.h"

namespace grainfield::testing {

/// Scores of one frame within the frame less a margin.
struct PositionScore : tracking::ClassScore {
    std::vector<int> partner;  ///< per true position the index found, −1 if missed
    double rms = 0;            ///< per axis, of the matched [px]; NaN: there are none
};

/// True positions in the margin may be matched and count nowhere (tracking::DetectionScores).
inline PositionScore score_positions(const std::vector<Vec2>& found, const std::vector<Vec2>& truth,
                                     double gate, int width, int height, double margin) {
    tracking::TruthFrame frame{truth, {}, {}};
    for (const Vec2 p : truth) {
        const bool is_inside = p.x >= margin && p.y >= margin && p.x <= width - 1 - margin &&
                               p.y <= height - 1 - margin;
        frame.classes.push_back(is_inside ? 1 : 0);
    }
    tracking::DetectionScores scores({"all"}, gate);
    std::vector<int> partner = scores.add(frame, found, {}).partner;
    const tracking::ClassScore& all = scores.classes()[0];
    return {all, std::move(partner), all.rmse_per_axis()};
}

}  // namespace grainfield::testing
