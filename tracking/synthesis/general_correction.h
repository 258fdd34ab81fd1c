#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/frame.h"
#include "tracking/detect/sphere_search.h"
#include "tracking/model/disc_profile.h"
#include "tracking/model/image_model.h"
#include "tracking/refine/joint_fit.h"
#include "tracking/synthesis/bias_correction.h"

namespace grainfield::tracking {

/// What discs leave over in a part of a frame: the first moments h_1 of the residual on the inner
/// rings of BiasTerms about each sphere, and the misfit of the whole part.
///
///   ⟨h(ρ_k) · h(ρ_{k+1})⟩ / RMS RMS for neighbouring rings, then ln of the RMS on each ring over
///   that of these rings, then ln of the misfit [contrast].
///
/// Outer rings depend on where spheres are: in a layer with few overlaps they hold little. The
/// misfit is less where less of the part is covered.
class ResidualPattern {
 public:
    static constexpr std::size_t kRings = 5;  ///< up to 0.75 a
    static constexpr std::size_t kNumbers = 2 * kRings;
    using Numbers = std::array<double, kNumbers>;

    void add(const BiasTerms::Terms& terms);
    /// Of all that were added, one at least. `misfit`: RMS residual without the noise [contrast].
    Numbers numbers(double misfit) const;

 private:
    std::array<double, kRings> squares_{};
    std::array<double, kRings - 1> products_{};  ///< with the next ring
};

/// Patterns of one kind of spheres, as a normal distribution over cameras and layers. A twentieth
/// of the variance of each number is added to its covariance.
struct PatternKind {
    std::vector<double> mean;
    std::vector<double> weights;  ///< inverse covariance, row by row
    double log_determinant = 0;   ///< of the covariance

    /// Squared distance from the mean by the inverse covariance (Mahalanobis).
    double squared_distance(const ResidualPattern::Numbers& numbers) const;
};

/// How discs err on mirror-like spheres over a panel, whatever the camera.
///
/// Learned once, by ridge regression, from ray-traced frames of cameras drawn at random
/// (bench/tracking/learn_general_correction.cpp). Each weight of BiasTerms is a linear function of
/// the size and the edge width of the discs, which the calibration of each frame gave.
struct GeneralCorrection {
    /// Of what a weight depends on: 1, edge width and diameter.
    static constexpr std::size_t kFilmTerms = 3;

    /// Of BiasTerms; the sum over all is what a position lacks [a].
    std::vector<std::array<double, kFilmTerms>> weights;
    /// A corrected position has, along each axis, the standard error σ' with
    ///
    ///   σ'² = max(share σ, σ_n)² + (doubt · shift)²,
    ///
    /// σ that of the disc, σ_n what the noise of the camera alone makes of it, `shift` the
    /// correction. `shares`, one a class of overlap.
    std::vector<double> shares;
    double doubt = 0;
    double least_width = 0, most_width = 0;        ///< of edges, that it was learned from [a]
    double least_diameter = 0, most_diameter = 0;  ///< apparent, likewise [a]
    PatternKind mirrors;                           ///< of the frames that it was learned from
    PatternKind rims;              ///< opaque discs with a bright rim, in the same layers
    double before = 0, after = 0;  ///< RMS error per axis on cameras left out, median of them [a]
    int cameras = 0;
    int spheres = 0;

    /// Of discs, both lengths in a. The weights are of these: a change of the constants in it needs
    /// learning anew.
    static std::array<double, kFilmTerms> film_terms(double edge_width, double apparent_diameter);

    /// Why it does not hold for discs of that size [px]; empty: it does. `diameter`: a [px].
    std::string refused(const DiscProfile& disc, double diameter) const;
    /// Distance of a pattern from the mean of mirrors by the inverse covariance, over √(numbers): 1
    /// RMS for mirrors [-].
    double unlikeness(const ResidualPattern::Numbers& numbers) const;
    /// ln of how much likelier it is of mirrors than of discs with a rim.
    double log_odds(const ResidualPattern::Numbers& numbers) const;
    /// What it is for them.
    BiasCorrection of(const DiscProfile& disc, double diameter) const;
};

/// That of the program, tracking/synthesis/general_correction.txt.
const GeneralCorrection& general_correction();
/// Throws std::invalid_argument for text that write_general_correction has not written.
GeneralCorrection read_general_correction(std::string_view text);
/// The text that read_general_correction reads.
std::string write_general_correction(const GeneralCorrection& general);

/// Whether the general correction holds for a frame.
struct CorrectionJudgement {
    int spheres = 0;                        ///< that were looked at
    double moved = 0;                       ///< by the correction, RMS per axis [a]
    double expected = 0;                    ///< RMS of their standard errors, misfit included [a]
    double unlikeness = 0;                  ///< GeneralCorrection::unlikeness
    double log_odds = 0;                    ///< GeneralCorrection::log_odds
    ResidualPattern::Numbers pattern = {};  ///< of the spheres that were looked at

    /// A correction is hardly larger than the errors that it corrects. On 40 frames of cameras that
    /// mirror the ratio was .7 to 1.3, on three crystals with wrong spheres 1.50 to 1.57, and on
    /// silhouettes in blurred light 2.6.
    bool is_too_large() const { return !(moved <= kMostMoved * expected); }
    static constexpr double kMostMoved = 2;  ///< chosen between the two
    /// Of neither kind, or rather of discs with a rim. Figures of both kinds:
    /// docs/tracking/mirror-judge.md.
    bool is_unlike() const { return !(unlikeness <= kMostUnlike && log_odds >= kLeastOdds); }
    static constexpr double kMostUnlike = 4;  ///< chosen; mirrors left out have 2.9 at most
    /// As if mirrors were a hundred times as usual. Left out, discs with a rim have -4.9 at most;
    /// two other frames of mirrors, one sharp and one small, have between this and -1.5.
    static constexpr double kLeastOdds = -4.6;
};

/// Of the middle of a frame, 40 a wide at most, in the light of the calibration. Spheres nearer
/// than 2 a to its border are left out. `counts`: the frame. `diameter`: a [px]. Same bits for any
/// number of threads. Takes the time of a cold search of that part.
CorrectionJudgement judge_correction(const GeneralCorrection& general, const Image& counts,
                                     const ImageModel& model, const DetectionOptions& detection,
                                     const RefinementOptions& refinement, double diameter,
                                     int threads);

}  // namespace grainfield::tracking
