#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/frame_source.h"
#include "core/option_table.h"
#include "core/support/progress.h"
#include "tracking/calibrate/calibration.h"
#include "tracking/calibrate/kept_calibration.h"
#include "tracking/camera/camera.h"
#include "tracking/layers/bilayer.h"
#include "tracking/link/linker.h"
#include "tracking/locate.h"
#include "tracking/model/visible_pixels.h"
#include "tracking/synthesis/film_synthesis.h"

namespace grainfield::tracking {

struct TrackOptions {
    CalibrationOptions calibration;
    DetectionOptions detection;
    RefinementOptions refinement;
    LinkOptions link;
    LayerOptions layers;
    std::optional<double> sphere_diameter;  ///< true diameter a [px]; empty: the apparent D
    bool synthesis = false;                 ///< positions and heights from rendered images
    SynthesisOptions synthesis_options;     ///< layers.height, where given, is the height
    std::optional<bool> correct_bias;       ///< true: learned from the film; empty: the general one
    std::optional<int> binning;  ///< side of the blocks that frames are fitted by [px]; empty: as
                                 ///< model_of_film decides
    std::int64_t stretch = 200;  ///< [frames] that start from one another
    std::optional<FrameSpan> part;        ///< measured, not linked; empty: all, and linked
    VisiblePixels visible;                ///< pixels that are looked at
    std::optional<KeptCalibration> kept;  ///< instead of a calibration on this film
    std::optional<CameraMap> camera;      ///< corrects positions; counts pixels of the source
    bool keeps = false;  ///< start as films will that use the calibration: frame 0 knows nothing
    int threads = 0;     ///< 0: all
    /// False: positions are not the result, need no correction, and are fitted pixel by pixel.
    bool corrects_bias = true;
    Verbosity verbosity = Verbosity::quiet;  ///< of the progress before the first frame
};

/// Every option of tracking, one table a stage ("calibrate", "detect", "refine", "link", "layers",
/// "synthesis", "track").
std::vector<OptionTable> describe(TrackOptions& options);

/// Throws OptionError if an option is given without one that it needs, or with one that excludes
/// it: the height of the cell, synthesis or a correction of the bias without the true diameter of
/// the spheres; either of the last two with a mask, a camera, blocks of pixels or the other; a kept
/// calibration with options that estimate or give what it holds; blocks that leave fewer than five
/// to a sphere.
void require_consistent(const TrackOptions& options);

/// Whether frames are compared with rendered ones, or a correction learned so is used: pixels are
/// then not binned.
bool needs_pixels(const TrackOptions& options);

/// How spheres are looked for: with the true diameter and the height of the cell, where they are
/// known, those without room are not taken.
DetectionOptions detection_of(const TrackOptions& options);

/// Whether discs of this apparent diameter are no usual picture of spheres of this true one, as
/// below; both in the same unit.
bool is_unusual_size(double apparent, double diameter);

/// Warns where discs of this apparent diameter D [px] are no usual picture of spheres of the given
/// diameter a: D/a is 0.7 (cores of mirrors) to 1 (silhouettes). Every length hangs on a.
void warn_of_unusual_size(double apparent, const TrackOptions& options, RunPlan& plan);

}  // namespace grainfield::tracking
