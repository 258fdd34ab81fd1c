#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/frame.h"
#include "core/vec2.h"
#include "tracking/detect/disc_correlation.h"
#include "tracking/detect/sphere_search.h"
#include "tracking/model/disc_model.h"
#include "tracking/model/visible_pixels.h"
#include "tracking/refine/joint_fit.h"
#include "tracking/refine/joint_information.h"

namespace grainfield::tracking {

/// What one frame holds.
struct Located {
    std::vector<Vec2> position;
    std::vector<Vec2>
        error;  ///< standard error per unit noise, all others unknown [px]; NaN: hidden
    std::vector<double> residual;   ///< local RMS of image − model [contrast]
    std::vector<double> explained;  ///< misfit that each one explains (JointFit) [contrast² px]
    double residual_rms = 0;
    double noise = 0;  ///< robust RMS where the model is flat [contrast]
    int passes = 0;
    std::int64_t added = 0, removed = 0;
    std::int64_t coarse_steps = 0, steps = 0;  ///< disc updates done on blocks, on pixels
    bool warm = false;                         ///< the start was used
    bool approached = false;                   ///< … after it was brought nearer on blocks
    int maps_skipped = 0;           ///< maps of likelihood gain that the residual made needless
    int maps_in_part = 0;           ///< computed only where the residual can hold a sphere
    std::int64_t trials = 0;        ///< discs added on trial (second_look.h)
    double evidence = 0;            ///< share of an isolated one's misfit that every disc explains
    std::vector<Vec2> fitted;       ///< every disc of the model, those at the border included
    std::int64_t unsettled = 0;     ///< spheres still moving after the last sweep
    std::int64_t rejected = 0;      ///< … by more than their standard error: not reported
    bool settled_detection = true;  ///< the last pass changed nothing
    double detect_seconds = 0, refine_seconds = 0;
};

/// Finds every sphere of a darkness image (SphereSearch) and its uncertainty. Large discs are
/// searched for on an image of blocks first, as large as leave seven to a diameter; what is missing
/// or too much is looked for again at full resolution. Sweeps bring each sphere to within a few
/// hundredths of a pixel, and joint Newton steps (JointInformation) all of them to rest. Where
/// edges meet as those of a blurred union (EdgeMeeting), or the profile is a learned one, this is
/// repeated, twice, on the image that the product of tanh discs should see there (as_product).
/// Pixels outside the image do not count.
///
/// A start (warm) replaces the search on blocks. If its spheres are expected to have moved by more
/// than kNear w since, they are refined on blocks first: a step there costs a quarter or less. All
/// are settled before the residual is asked whether any are missing: the map of likelihood gain is
/// computed only where it can hold a sphere. If it can, the search is that of a cold frame.
class Locator {
 public:
    Locator(int width, int height, DiscModel model, int threads);
    /// `start`: where the spheres were; empty: unknown. `step`: how far they have moved since, RMS
    /// [px]; 0: unknown, but not far.
    Located locate(const Image& darkness, const DetectionOptions& detection,
                   const RefinementOptions& refinement, const std::vector<Vec2>& start = {},
                   double step = 0);
    /// The same of the image whose rows `darkness` writes, in parallel: it is not kept elsewhere.
    Located locate(const JointFit::WriteRow& darkness, const DetectionOptions& detection,
                   const RefinementOptions& refinement, const std::vector<Vec2>& start = {},
                   double step = 0);
    /// Others are not looked at, in all frames to come.
    void set_visible(const VisiblePixels& visible);
    /// Results do not depend on it.
    void set_threads(int threads);
    const DiscProfile& disc() const { return model_.disc; }
    /// Image − model of the fit that came last: as the product of tanh discs sees the image,
    /// 0 where nothing is looked at [contrast].
    Image residual();
    /// Of the model fitted last.
    const PaddedImage& transmission() const { return fit_.transmission(); }

    static constexpr double kNear = 0.05;  ///< [w]
    static constexpr int kApproachSpacing = 2;

 private:
    /// Discs at rest, and what each explains; the latter is empty where nothing is known of it.
    struct Scene {
        std::vector<Vec2> position;
        std::vector<double> explained;
    };
    double clearance(Vec2 p) const;
    /// What is known when nobody moves any more.
    struct Settled {
        JointInformation information;
        std::vector<double> gain;                ///< undrawn
        std::optional<ResidualBlocks> residual;  ///< less that
        std::uint64_t revision = 0;              ///< of the fit then
    };
    void find_all(SphereSearch& search, const DetectionOptions& detection,
                  const RefinementOptions& refinement, bool exactly, Settled& settled,
                  Located& found);
    Scene approached(const RefinementOptions& refinement, const std::vector<Vec2>& start,
                     Located& found);
    void place_all(const Scene& scene, std::optional<double> left);
    double far(double noise) const;
    double least_drawn(double noise, const RefinementOptions& refinement) const;
    bool settle(SphereSearch& search, const RefinementOptions& refinement, bool exactly,
                JointInformation& information, Located& found);
    void settle_rest(SphereSearch& search, const RefinementOptions& refinement,
                     JointInformation& information);
    void search_coarsely(const DetectionOptions& detection, const RefinementOptions& refinement,
                         Located& found);

    DiscModel model_;
    int factor_;
    int threads_;
    DiscCorrelation correlation_;
    JointFit fit_;
    std::optional<DiscCorrelation> coarse_;
    std::optional<JointFit> coarse_fit_;
    std::optional<JointFit> approach_;  ///< on every kApproachSpacing-th row of blocks
    /// Of the discs as placed, if nothing has been drawn since.
    std::optional<JointInformation> early_;
    std::uint64_t early_revision_ = 0;
    Image coarse_image_;
    Image clearance_;  ///< squared distance to what is not visible [px²]; empty: all is
};

}  // namespace grainfield::tracking
