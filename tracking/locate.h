#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/frame.h"
#include "core/option_table.h"
#include "core/vec2.h"
#include "tracking/detect/disc_correlation.h"
#include "tracking/disc_profile.h"
#include "tracking/refine/joint_fit.h"

namespace grainfield::tracking {

struct DetectionOptions {
    double cutoff = 3;  ///< a first candidate needs 1/χ² above this [-]
    /// Two centres nearer than this are one sphere [D]. In a cell of height L_z spheres cannot come
    /// closer in projection than sqrt(a² − (L_z − a)²) = 0.34 a for L_z = 1.94 a.
    double separation = 0.42;
    /// A sphere must explain this share of the misfit that an isolated one explains [-]. On the
    /// real frame spheres lie above 0.25 and doubtful ones below 0.15 (docs/tracking.md).
    double evidence = 0.15;
    double border = 0.25;     ///< centres nearer to the image border are not reported [D]
    double significance = 6;  ///< … and this many standard deviations of the noise [-]
    int max_passes = 12;      ///< most rounds of adding and removing spheres
};

OptionTable describe(DetectionOptions& options);

/// What one frame holds.
struct Located {
    std::vector<Vec2> position;
    std::vector<Vec2> error;       ///< conditional standard error [px]; NaN: hidden
    std::vector<double> residual;  ///< local RMS of image − model [contrast]
    Image transmission;            ///< of the fitted model
    double residual_rms = 0;
    double noise = 0;  ///< robust RMS where the model is flat [contrast]
    int passes = 0;
    std::int64_t added = 0, removed = 0;
    std::vector<Vec2> fitted;       ///< every disc of the model, those at the border included
    std::int64_t unsettled = 0;     ///< spheres still moving after the last sweep
    bool settled_detection = true;  ///< the last pass changed nothing
    double detect_seconds = 0, refine_seconds = 0;
};

/// Finds every sphere of a darkness image: peaks of Shattuck's χ² start the scene; then, pass by
/// pass, all positions are refined together, spheres that explain too little of the image are taken
/// out, and the map of likelihood gain says where one more sphere would explain what is left.
/// Hidden spheres of the other layer appear this way, from the residual of what covers them. Ends
/// when a pass changes nothing. Pixels outside the image do not count.
class Locator {
 public:
    Locator(int width, int height, const DiscProfile& disc, int threads);
    Located locate(const Image& darkness, const DetectionOptions& detection,
                   const RefinementOptions& refinement, const std::vector<Vec2>& start = {});
    const DiscProfile& disc() const { return disc_; }

 private:
    DiscProfile disc_;
    void seed(JointFit& fit, const Image& darkness, const DetectionOptions& detection,
              const std::vector<Vec2>& start);

    int threads_;
    DiscCorrelation correlation_;
};

}  // namespace grainfield::tracking
