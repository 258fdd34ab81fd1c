#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "analysis/order/bond_order.h"
#include "core/run_plan.h"
#include "core/snapshot.h"
#include "simulate/render/motion/lasting_ids.h"
#include "tracking/model/disc_profile.h"
#include "tracking/score/detection_scores.h"
#include "tracking/score/layer_score.h"
#include "tracking/score/track_scores.h"

namespace grainfield::pipelines {

/// How a scene is seen: what sorts true particles into classes and sets the bound.
struct ScoredView {
    int width = 0, height = 0;   ///< of a frame [px]
    double sphere_diameter = 0;  ///< true a [px]
    tracking::DiscProfile disc;  ///< as the tracker calibrated it
    double noise = 0;            ///< RMS noise of the camera [contrast]; 0: no bounds
    /// Spheres nearer than this in projection overlap and are of one cluster [a].
    double contact = 1;
    Vec2 span;  ///< of a crossing (simulate::Continuity) [px]; 0: the frame
    int threads = 1;
};

/// Classes 0 … 6; those after them are bins of the distance to the nearest true particle.
enum class TruthClass { all, isolated, liquid, crystal, top, bottom, border };
constexpr std::size_t kTruthClasses = 7;

/// Lower edges of the distance bins, kDistanceStep wide [a].
constexpr double kLeastDistance = 0.3;
constexpr double kDistanceStep = 0.05;
constexpr std::size_t kDistanceBins = 18;

std::vector<std::string> truth_class_names();

/// Sorts the true particles of a frame:
///   border   centre nearer than D to an edge of the frame but not nearer than D/4, where the
///            tracker reports nothing; in no other class,
///   all      centre at least D inside,
///   isolated of those, no other centre within D + 4w: edges do not touch (joint_covariance),
///   crystal  |Q4| ≥ 0.7, liquid: below (neighbours outside the frame count too),
///   top, bottom  the true layer.
/// Bounds are set if the noise is known. Positions in px.
tracking::TruthFrame classify_truth(const Snapshot& truth, const ScoredView& view,
                                    const std::vector<double>& abs_q4);

/// Scores of a whole run against its truth, frame by frame. Frames that were not tracked count: all
/// their particles are missed.
///
/// Scores of tracks are over the same points as those of class `all`: true particles of that class,
/// and those found that belong to it (tracking::FrameMatch), so that without any wrong link their
/// JSC is the Jaccard index of the class. A true track continues while it can be followed
/// (simulate::Continuity): through the border, but not out of the frame and back.
class ValidationScores {
 public:
    explicit ValidationScores(const ScoredView& view);

    /// `found` may be empty: nothing was tracked. Positions in px, truth with identities.
    void add(const Snapshot& truth, const Snapshot& found);

    const ScoredView& view() const { return view_; }
    const tracking::DetectionScores& detection() const { return detection_; }
    const tracking::LayerScore& layers() const { return layers_; }
    /// Compares all frames added so far; memory 100 B per pair of tracks that came close.
    tracking::TrackScores tracks() const;

    /// RMS and mean of |Q4| found − true over the matched particles of class `all` [-].
    double q4_rms() const;
    double q4_bias() const;
    std::int64_t q4_samples() const { return q4_count_; }

 private:
    void add_tracks(const Snapshot& truth, const Snapshot& found,
                    const std::vector<std::uint64_t>& classes, const tracking::FrameMatch& match);
    void add_q4(const Snapshot& found, const std::vector<double>& true_q4,
                const std::vector<std::uint64_t>& classes, const std::vector<int>& partner);

    ScoredView view_;
    tracking::DetectionScores detection_;
    tracking::LayerScore layers_;
    std::vector<tracking::IdentifiedFrame> found_tracks_, true_tracks_;
    simulate::Continuity continuity_;
    std::unordered_map<std::int64_t, std::int64_t> track_;  ///< present one of each true identity
    std::int64_t tracks_begun_ = 0;
    double q4_sum_ = 0, q4_squares_ = 0;
    std::int64_t q4_count_ = 0;
};

/// Share of places taken at random that have one of these spheres within the gate: 1 − exp(−n π g²)
/// for n spheres a square pixel, if those lay at random, too. Spheres that keep apart are met a
/// little more often.
double recall_by_chance(const ValidationScores& scores);

/// Warns (WarningCode::other_truth) where fewer than half of the true places were found though as
/// many spheres were: the places are likely those of another film, shifted, or in another unit.
void warn_of_other_truth(const ValidationScores& scores, RunPlan& plan);

}  // namespace grainfield::pipelines
