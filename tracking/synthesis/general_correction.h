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

/// How discs err on mirror-like spheres over a panel, whatever the camera.
///
/// Learned once, by ridge regression, from ray-traced frames of cameras drawn at random
/// (bench/tracking/learn_general_correction.cpp). Each weight of BiasTerms is a linear function of
/// the size and the edge width of the discs, which the calibration of each frame gave.
struct GeneralCorrection {
    /// Of what a weight depends on: 1, edge width and diameter.
    static constexpr std::size_t kFilmTerms = 3;

    std::vector<std::array<double, kFilmTerms>> weights;  ///< of BiasTerms [a]
    std::vector<double> shares;  ///< of a standard error that remain, by class of overlap
    double least_width = 0, most_width = 0;        ///< of edges, that it was learned from [a]
    double least_diameter = 0, most_diameter = 0;  ///< apparent, likewise [a]
    double before = 0, after = 0;  ///< RMS error per axis on cameras left out, median of them [a]
    int cameras = 0;
    int spheres = 0;

    /// Of discs in units of a, about their means and in units of their spread.
    static std::array<double, kFilmTerms> film_terms(double edge_width, double apparent_diameter);

    /// Why it does not hold for discs of that size [px]; empty: it does. `diameter`: a [px].
    std::string refused(const DiscProfile& disc, double diameter) const;
    /// What it is for them.
    BiasCorrection of(const DiscProfile& disc, double diameter) const;
};

/// That of the program, tracking/synthesis/general_correction.txt.
const GeneralCorrection& general_correction();
/// Throws std::invalid_argument for text that write_general_correction has not written.
GeneralCorrection read_general_correction(std::string_view text);
std::string write_general_correction(const GeneralCorrection& general);

/// How far a correction moves the spheres of a frame.
struct CorrectionSize {
    int spheres = 0;      ///< that were looked at
    double moved = 0;     ///< RMS per axis [a]
    double expected = 0;  ///< RMS of their standard errors, misfit included [a]

    /// No correction can be larger than the errors that it corrects. On frames of other cameras
    /// than those learned from the ratio is .7 to 1.2, on silhouettes 2.6.
    bool is_too_large() const { return moved > 1.5 * expected; }
};

/// Of the middle of a frame, 40 a wide at most. Its border is left out.
CorrectionSize correction_size(const BiasCorrection& correction, const Image& counts,
                               const ImageModel& model, const DetectionOptions& detection,
                               const RefinementOptions& refinement, double diameter, int threads);

}  // namespace grainfield::tracking
