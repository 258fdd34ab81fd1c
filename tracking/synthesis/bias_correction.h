#pragma once

#include <string>
#include <vector>

#include "core/frame.h"
#include "core/vec2.h"
#include "tracking/model/padded_image.h"
#include "tracking/synthesis/bias_terms.h"

namespace grainfield::tracking {

/// How the positions of fitted discs err on mirror-like spheres: learned from a film's own
/// synthesised frames (learn_bias), or from those of many cameras (general_correction).
struct BiasCorrection {
    double diameter = 0;            ///< true diameter that it was learned for [px]
    double height = 0;              ///< height of the cell, likewise [a]; general: 0
    double camera_distance = 0;     ///< likewise [a]; 0: telecentric
    std::vector<double> weights;    ///< of BiasTerms; their sum is what a position lacks [a]
    std::vector<double> quality;    ///< bounds of the classes by local residual [contrast]
    std::vector<double> remaining;  ///< RMS error per axis, by overlap, then by residual [a]
    std::vector<double> shares;     ///< of a standard error that remain, by overlap; general only
    double doubt = 0;               ///< standard error of a correction, as a share of it; likewise
    double before = 0, after = 0;   ///< RMS error per axis on held-out frames [a]

    /// Of many cameras: it is not kept with a calibration.
    bool is_general() const { return !shares.empty(); }
    bool operator==(const BiasCorrection&) const = default;
};

/// All numbers that positions and their errors depend on: equal for the same corrections.
std::vector<double> numbers_of(const BiasCorrection& correction);

/// Bounds of the classes of overlap: distance of the nearest other disc [a].
inline constexpr double kOverlapBounds[] = {0.6, 0.8, 0.95};
inline constexpr int kOverlapClasses = 4;
inline constexpr int kQualityClasses = 4;

/// Class of overlap of a sphere whose nearest neighbour is that far away [a]: 0 … 3, from the most.
std::size_t overlap_class(double nearest);
/// Class of a sphere whose nearest neighbour is that far away [a]; index of `remaining`.
std::size_t class_of(const BiasCorrection& correction, double nearest, double residual);

/// What positions in one frame lack. All lengths in px. The images outlive it.
class BiasCorrector {
 public:
    /// `darkness`, `residual`: of the fit that gave `discs`, all of its discs. `diameter`: a, > 0.
    BiasCorrector(const BiasCorrection& correction, const Image& darkness, const Image& residual,
                  const std::vector<Vec2>& discs, double diameter);
    /// Of a fit as it stands.
    BiasCorrector(const BiasCorrection& correction, const PaddedImage& darkness,
                  const PaddedImage& transmission, const std::vector<Vec2>& discs, double diameter);

    const BiasTerms& terms() const { return terms_; }
    /// Whether a place is far enough from the border.
    bool reaches(Vec2 place) const;
    /// The place corrected; itself where the border is too near.
    Vec2 corrected(Vec2 place) const;
    struct Corrected {
        Vec2 position;       ///< [px]
        double nearest = 0;  ///< distance of the nearest disc but for the one at the place [a]
    };
    /// The same of a place that it reaches.
    Corrected corrected_within(Vec2 place) const;

 private:
    BiasCorrector(BiasTerms terms, const BiasCorrection& correction, double diameter, int width,
                  int height);

    BiasTerms terms_;
    BiasTerms::Weights weights_;
    double diameter_;
    int width_, height_;
};

}  // namespace grainfield::tracking
