#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/frame.h"
#include "core/vec2.h"
#include "tracking/detect/coarse_search.h"
#include "tracking/detect/disc_correlation.h"
#include "tracking/detect/other_arrangement.h"
#include "tracking/detect/sphere_search.h"
#include "tracking/model/disc_model.h"
#include "tracking/model/visible_pixels.h"
#include "tracking/refine/joint_fit.h"
#include "tracking/refine/joint_solver.h"
#include "tracking/synthesis/bias_correction.h"

namespace grainfield::tracking {

/// What one frame holds.
struct Located {
    std::vector<Vec2> position;
    std::vector<Vec2>
        error;  ///< standard error per unit noise, all others unknown [px]; NaN: hidden
    std::vector<double> residual;       ///< local RMS of image − model [contrast]
    std::vector<double> edge_residual;  ///< the same, of the pixels that a position is read from
    std::vector<double> explained;  ///< misfit that each one explains (JointFit) [contrast² px]
    double residual_rms = 0;
    double correlation = 1;  ///< κ of the misfit (misfit_correlation.h) [-]
    double noise = 0;        ///< robust RMS where the model is flat [contrast]
    int passes = 0;
    std::int64_t added = 0, removed = 0;
    std::int64_t coarse_steps = 0, steps = 0;  ///< disc updates done on blocks, on pixels
    bool warm = false;                         ///< the start was used
    bool approached = false;                   ///< … after it was brought nearer on blocks
    int maps_skipped = 0;          ///< maps of likelihood gain that the residual made needless
    int maps_in_part = 0;          ///< computed only where the residual can hold a sphere
    std::int64_t trials = 0;       ///< discs added on trial (second_look.h)
    std::int64_t trials_kept = 0;  ///< … that stayed
    std::int64_t mended = 0;       ///< … of them where one disc took the place of two
    int joint_steps = 0;           ///< Newton steps of all discs at once
    int arrangements = 0;          ///< places where a search for cores found other discs
    int arrangements_taken = 0;    ///< … that explained the frame better
    double evidence = 0;           ///< share of an isolated one's misfit that every disc explains
    bool doubtful_are_false = false;  ///< they hardly had room (SphereSearch::Summary)
    std::vector<Vec2> fitted;         ///< every disc of the model, those at the border included
    std::int64_t unsettled = 0;       ///< spheres still moving after the last sweep
    std::int64_t rejected = 0;        ///< … by more than their standard error: not reported
    bool settled_detection = true;    ///< the last pass changed nothing
    double detect_seconds = 0, refine_seconds = 0;
};

/// What was found in blocks, in pixels of the frame.
Located in_frame(Located found, Binning blocks);

/// Finds every sphere of a darkness image and its uncertainty, in stages.
///
/// 1. Start: large discs are searched for on an image of blocks (CoarseSearch), as large as leave
///    seven to a diameter; others on the pixels (SphereSearch). A start (warm) replaces the search.
///    If its spheres are expected to have moved by more than kNear w, they are refined on blocks
///    first: a step there costs a quarter or less.
/// 2. Search: spheres are added and removed until the residual holds none. A warm frame is settled
///    first; the map of likelihood gain is then computed only where it can hold a sphere.
/// 3. Settle: sweeps bring each sphere to within a few hundredths of a pixel, joint Newton steps
///    (JointSolver) all of them to rest.
/// 4. Second look: discs on trial where the model leaves unusually much (second_look.h).
/// 5. Cores: on a cold frame that the model does not describe well, a second search looks for
///    smaller and sharper discs, and where it finds other ones the better arrangement stays
///    (other_arrangement.h).
/// 6. One for two: on a cold frame, where spheres have no room one disc takes the place of two
///    (one_for_two.h).
/// 7. Overlaps: where the model is not the product of transmissions, 3. is repeated on the image
///    that the product should see there (product_image.h): twice, on warm frames once.
/// 8. Doubtful spheres: where most hardly had room (sphere_room.h), 2. to 4., 6. and 7. once more
///    without.
/// 9. Report: positions, standard errors, residuals; unsettled and cut spheres are left out.
///
/// Pixels outside the image do not count.
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
    /// RMS of image − model that the calibration left, less than which steps need not bring
    /// [contrast]. 0, as it begins: only the noise of each frame limits positions.
    void expect_misfit(double rms) { expected_misfit_ = rms; }
    /// Of the discs, by which the search judges whether doubtful ones have room. Positions stay
    /// those of the fit.
    void set_correction(const BiasCorrection& correction) { correction_ = correction; }
    /// Results do not depend on it.
    void set_threads(int threads);
    const DiscProfile& disc() const { return model_.disc; }
    /// Image − model of the fit that came last, as the product of transmissions sees the image; 0
    /// where nothing is looked at [contrast].
    Image residual();
    /// The same into an image of that size.
    void write_residual(Image& residual);
    /// Of the model fitted last.
    const PaddedImage& transmission() const { return fit_.transmission(); }

    static constexpr double kNear = 0.05;  ///< [w]

 private:
    struct Frame;
    void start_discs(Frame& frame, const std::vector<Vec2>& start, double step);
    StartingDiscs approached(Frame& frame, const std::vector<Vec2>& start);
    void place_all(const StartingDiscs& discs, std::optional<double> left);
    void search(Frame& frame);
    double unexplained_by_model(const Frame& frame) const;
    bool settle(Frame& frame, bool is_last);
    void settle_and_judge(Frame& frame);
    bool is_searched_for_cores(const Frame& frame) const;
    void compare_with_cores(Frame& frame);
    void put_one_for_two(Frame& frame);
    bool take_better(Frame& frame);
    void sweep_to_rest(Frame& frame);
    void fit_overlaps(Frame& frame);
    void search_without_doubtful(Frame& frame);
    Located report(Frame& frame);
    double far(double noise) const;
    double least_drawn(double noise, const RefinementOptions& refinement) const;
    RefinementOptions sweeps_of(const RefinementOptions& refinement) const;
    RefinementOptions rough_sweeps_of(const RefinementOptions& refinement) const;
    double clearance(Vec2 p) const;

    DiscModel model_;
    int threads_;
    double expected_misfit_ = 0;
    std::optional<BiasCorrection> correction_;
    DiscCorrelation correlation_;
    JointFit fit_;
    JointSolver solver_;
    std::optional<CoarseSearch> coarse_;
    std::unique_ptr<Locator> cores_;  ///< for smaller and sharper discs; made when first needed
    Image original_, seen_;           ///< with meeting edges, and as the product should see them
    VisiblePixels visible_;
    Image clearance_;  ///< squared distance to what is not visible [px²]; empty: all is
};

}  // namespace grainfield::tracking
