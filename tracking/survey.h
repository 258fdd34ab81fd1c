#pragma once

#include <cstdint>
#include <vector>

#include "core/frame.h"
#include "tracking/calibrate/edge_fit.h"
#include "tracking/calibrate/illumination.h"
#include "tracking/tracker.h"

namespace grainfield::tracking {

/// One frame as the tracker sees it, for people to judge its settings by.
struct Survey {
    std::int64_t frame = 0;        ///< index in the source
    Located found;                 ///< from a cold start
    std::vector<Vec2> error;       ///< standard errors of the discs, not corrected [px]
    Image residual;                ///< image − model, 0 where nothing is looked at [contrast]
    std::vector<double> evidence;  ///< what each sphere explains, of what an isolated one does [-]
    std::vector<RadialBin> profile;  ///< darkness about spheres where nothing else is near
};

/// Looks at single frames with a calibrated image model.
class Surveyor {
 public:
    /// The model must outlive the surveyor.
    Surveyor(const ImageModel& model, const TrackOptions& options, int width, int height);

    /// A frame of that size and status ok.
    Survey look(const Frame& frame);

 private:
    const ImageModel& model_;
    DetectionOptions detection_;
    RefinementOptions refinement_;
    VisiblePixels visible_;
    Locator locator_;
    IlluminationFollower illumination_;
};

/// From each point to its nearest neighbour [px]; beyond `farthest`: infinity. O(N) at fixed
/// density.
std::vector<double> nearest_distances(const std::vector<Vec2>& points, double farthest);

/// How unevenly coordinates fall between the pixels: the length of the mean of exp(2πi x), 0 for
/// even, 1 where all have one phase; and what chance gives, sqrt(π/4N) on average.
struct PhaseBias {
    double x = 0, y = 0, chance = 0;
};
PhaseBias phase_bias(const std::vector<Vec2>& points);

}  // namespace grainfield::tracking
