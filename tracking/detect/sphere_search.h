#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/frame.h"
#include "core/option_table.h"
#include "tracking/detect/disc_correlation.h"
#include "tracking/detect/residual_blocks.h"
#include "tracking/layers/sphere_cell.h"
#include "tracking/model/binning.h"
#include "tracking/point_grid.h"
#include "tracking/refine/joint_fit.h"

namespace grainfield::tracking {

struct BiasCorrection;

/// How many spheres a search is to find.
enum class SearchGoal {
    every_sphere,
    most_spheres,  ///< in one pass, without a second look: enough to calibrate the image model on
};

/// When a second search looks for the cores of spheres, if the model describes the frame badly.
enum class CoreSearch {
    never,
    cold_frames,  ///< on frames without a start
    this_frame,   ///< in any case: the start is rough
};

struct DetectionOptions {
    double cutoff = 3;  ///< a first candidate needs 1/χ² above this [-]
    /// Two centres nearer than this are one sphere [D]: SphereCell::least_distance of a cell of
    /// 1.94 a, 0.341 a, rounded down; D ≤ a.
    double separation = 0.34;
    /// A sphere must explain this share of the misfit that an isolated one explains [-]. Auto: 0.04
    /// to 0.15, the more the image model leaves unexplained; 0.08 at most where a is known, or 0.25
    /// where those that explain less hardly have room (docs/tracking/room.md).
    std::optional<double> evidence;
    /// So it was in the frame that this one starts from.
    bool doubtful_are_false = false;
    /// a [px]; if known, a sphere that explains less than 0.25 must have room between the plates.
    std::optional<double> sphere_diameter;
    double cell_height = 1.94;  ///< distance of the plates L_z [a]
    double border = 0.25;       ///< centres nearer to the image border are not reported [D]
    /// The outer pixel's centre lies that far outside of that of the outer block [px, of blocks].
    double beyond = 0;
    double significance = 6;  ///< … and this many standard deviations of the noise [-]
    int max_passes = 12;      ///< most rounds of adding and removing spheres
    SearchGoal goal = SearchGoal::every_sphere;
    CoreSearch cores = CoreSearch::cold_frames;
};

OptionTable describe(DetectionOptions& options);

/// The same of frames seen by blocks.
DetectionOptions in_blocks(DetectionOptions options, Binning blocks);

/// The search for the spheres of one darkness image at one resolution.
///
/// Peaks of Shattuck's χ² start the scene; then, pass by pass, all positions are refined together,
/// spheres that explain too little of the image are taken out, and the map of likelihood gain says
/// where one more sphere would explain what is left. Hidden spheres of the other layer appear this
/// way, from the residual of what covers them. Ends when a pass changes nothing. A second look
/// (second_look.h) finds those that their neighbours have moved to cover for.
class SphereSearch {
 public:
    /// In the image that `fit` was started on. `correlation` must be made for its size; both
    /// outlive the search. `correction`: of what was fitted, by which room is judged; null:
    /// none. It needs options.sphere_diameter.
    SphereSearch(JointFit& fit, DiscCorrelation& correlation, const DetectionOptions& options,
                 const BiasCorrection* correction = nullptr);

    JointFit& fit() { return fit_; }

    /// Puts a disc on every peak of 1/χ² above the cutoff.
    void seed();

    /// Passes until nothing changes.
    void run(const RefinementOptions& rough);

    /// Adds discs on trial where the model leaves unusually much (second_look.h). Whether any disc
    /// took a step.
    bool look_again(const RefinementOptions& refinement, const ResidualBlocks& residual);

    /// Puts one disc in the place of two where spheres have no room (one_for_two.h), if a is known
    /// and positions are corrected. Whether any was tried.
    bool put_one_for_two(const RefinementOptions& refinement);

    /// Whether a sphere might be missing, judged from what is left of the image. Counts as a pass
    /// if none can be.
    bool misses_any(const ResidualBlocks& residual);
    /// Whether one might be missing that explains half of what an isolated one does, beyond the
    /// usual misfit about it. Of every_sphere, a second look finds the others. Counts as
    /// misses_any().
    bool misses_whole_ones(const ResidualBlocks& residual);

    /// Sweeps until nothing moves. Two discs that come together then are one: the weaker one goes
    /// and its neighbours settle.
    void finish(const RefinementOptions& refinement, Drawing drawing);
    /// Sweeps, and judges no sphere.
    void sweep(const RefinementOptions& refinement, Drawing drawing);

    /// Takes out what is false now; all places may be tried again.
    void start_over();
    /// What the frame before showed of doubtful spheres does not hold.
    void begin_cold() { summary_.doubtful_are_false = false; }

    /// The image or the positions are not those that were judged last.
    void forget_judgement() { judged_at_ = -1; }

    struct Summary {
        int passes = 0;
        std::int64_t added = 0, removed = 0;
        std::int64_t steps = 0;         ///< disc updates done
        int maps_skipped = 0;           ///< maps of gain that the residual made needless
        int maps_in_part = 0;           ///< computed only where the residual can hold a sphere
        std::int64_t trials = 0;        ///< discs added on trial
        std::int64_t trials_kept = 0;   ///< … that stayed
        std::int64_t mended = 0;        ///< … of them where one disc took the place of two
        bool settled_detection = true;  ///< the last pass changed nothing
        double evidence = 0;            ///< share of an isolated one's misfit that all explain
        /// Most that explained less than 0.25 of an isolated one hardly had room: all are false.
        bool doubtful_are_false = false;
        double noise = 0;   ///< robust RMS where the model is flat [contrast]
        double misfit = 0;  ///< RMS where there are spheres, without what is missing [contrast]
        double detect_seconds = 0, refine_seconds = 0;
    };
    const Summary& summary() const { return summary_; }

 private:
    void forget_rejections();
    bool is_tried_out(Vec2 place) const;
    std::int64_t remove_unfounded();
    bool finds_doubtful_false();
    SphereCell cell() const;
    bool is_whole(Vec2 p) const;
    void split(std::uint32_t j, Vec2 place);
    bool misses(const ResidualBlocks& residual, double least);
    double least_gain(const ResidualBlocks& residual) const;
    std::vector<PixelBlock> where_gain_reaches(const ResidualBlocks& residual, double least) const;
    Image gain_above(const ResidualBlocks& residual, double least);
    std::int64_t add_missing();

    DetectionOptions options_;
    DiscProfile disc_;
    DiscCorrelation& correlation_;
    JointFit& fit_;
    const BiasCorrection* correction_;
    PointGrid rejected_;           ///< places not to be tried again
    PointGrid tried_;              ///< where discs were added
    double separation_;            ///< [px]
    bool asks_for_room_ = false;   ///< of doubtful spheres
    double threshold_ = 0;         ///< least misfit that a sphere must explain [contrast² px]
    double rejected_at_ = 0;       ///< the highest threshold that those rejected fell short of
    std::int64_t judged_at_ = -1;  ///< disc updates done when no disc had to go; −1: not known
    Summary summary_;
};

}  // namespace grainfield::tracking
