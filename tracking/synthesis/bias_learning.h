#pragma once

#include <cstdint>
#include <string>

#include "core/frame.h"
#include "core/support/progress.h"
#include "tracking/locate.h"
#include "tracking/model/image_model.h"
#include "tracking/synthesis/bias_correction.h"

namespace grainfield::tracking {

/// What a correction is learned for.
struct BiasSetting {
    double diameter = 0;         ///< true diameter a [px]
    double height = 1.94;        ///< of the cell [a]
    double camera_distance = 0;  ///< [a]; 0: telecentric
    DetectionOptions detection = {};
    RefinementOptions refinement = {};
    double part = 40;  ///< side of the square that is rendered [a] (parts_of)
    int frames = 8;    ///< that are rendered of one part; half as many of each of nine
    std::uint64_t seed = 1;
    Verbosity verbosity = Verbosity::quiet;  ///< of the progress
};

struct BiasLearning {
    BiasCorrection correction;
    std::string refused;       ///< why it is not to be applied; empty: it is
    double disc_misfit = 0;    ///< of the discs, noise taken away [contrast]
    double mirror_misfit = 0;  ///< of the rendering, noise taken away [contrast]
    int parts = 0;             ///< of the frame that were rendered
    int frames = 0;            ///< that were rendered, all parts together
    int spheres = 0;           ///< learned from, all frames together
};

/// Learns how the tracker errs on mirror-like spheres from frames whose truth is known.
///
/// 1. The spheres of `counts` are found. Heights, optics and light are fitted to its middle, or to
///    nine parts where it is large (parts_of, fitted_part).
/// 2. These spheres are moved at random (moved_at_random) and rendered, with the noise of the
///    frame, and the tracker finds them as in the film.
/// 3. Ridge regression of error on BiasTerms. Its strength is the one with the least error on
///    frames left out, one of each part at a time.
/// 4. The error that is left on those, by class, is the standard error to come.
///
/// It is refused where its gain is not clear:
/// - rendering explains the frame little better than discs;
/// - RMS or median of the frames left out falls by less than a tenth, or grows in any part;
/// - the frame itself would be corrected by far more than they;
/// - the rendering of the frame, heights and light as fitted, does not come nearer to the image by
///   a tenth when spheres are put at corrected positions instead of those of discs, or gets worse
///   in any part.
///
/// Same bits for any number of threads. Takes the time of 30 to 120 warm frames. Throws
/// Interrupted.
BiasLearning learn_bias(const Image& counts, const ImageModel& model, const BiasSetting& setting,
                        int threads);

}  // namespace grainfield::tracking
