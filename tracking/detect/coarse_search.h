#pragma once

#include <vector>

#include "core/frame.h"
#include "core/vec2.h"
#include "tracking/detect/disc_correlation.h"
#include "tracking/detect/sphere_search.h"
#include "tracking/model/binning.h"
#include "tracking/model/disc_profile.h"
#include "tracking/model/visible_pixels.h"
#include "tracking/refine/joint_fit.h"

namespace grainfield::tracking {

/// Discs to begin a fit with, and what each is known to explain [contrast² px]; the latter is empty
/// where nothing is known of it.
struct StartingDiscs {
    std::vector<Vec2> position;
    std::vector<double> explained;
};

/// Search and first steps of a fit on an image of blocks of pixels: its pixels are fewer by the
/// square of the factor. What is left at the right and lower border is left out.
class CoarseSearch {
 public:
    CoarseSearch(int width, int height, const DiscProfile& disc, int factor, int threads);
    /// There are blocks of more than a pixel, and enough of them.
    static bool suits(int width, int height, int factor);

    void set_visible(const VisiblePixels& visible);
    void set_threads(int threads);

    /// All spheres of a frame.
    StartingDiscs search(const PaddedImage& darkness, const DetectionOptions& detection,
                         const RefinementOptions& rough);
    /// Of the last search.
    const SphereSearch::Summary& summary() const { return summary_; }

    struct Approach {
        bool is_near = false;  ///< else a cold search is the shorter way
        std::int64_t steps = 0;
        StartingDiscs discs;  ///< if is_near
    };
    /// Spheres that have moved since `start`, refined to a few hundredths of a pixel on every
    /// second row of blocks. Nothing is added or removed. A disc that goes far stays at its start:
    /// the fine search judges by its own pixels. Not near if the misfit of half a sphere or more is
    /// left on a fifth of the image, or if a quarter of the discs go far.
    Approach approach(const PaddedImage& darkness, const std::vector<Vec2>& start,
                      const RefinementOptions& rough);

 private:
    Binning blocks_;
    int threads_;
    double diameter_;  ///< in the frame [px]
    DiscCorrelation correlation_;
    JointFit fit_;
    JointFit approach_;  ///< on every kRowSpacing-th row of blocks
    SphereSearch::Summary summary_;
    Image image_;
};

}  // namespace grainfield::tracking
