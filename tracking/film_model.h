#pragma once

#include <string>

#include "core/frame_source.h"
#include "core/run_plan.h"
#include "tracking/calibrate/film_calibration.h"
#include "tracking/film_bias.h"
#include "tracking/track_options.h"

namespace grainfield::tracking {

/// What all frames of a film are fitted with, and what their positions are corrected with.
struct FilmModel {
    FilmCalibration film;             ///< of pixels, or of blocks of them (ImageModel::binning)
    FilmBias bias;                    ///< undecided where nothing could be calibrated
    std::string binning_reason = {};  ///< why frames are fitted by these blocks, or by pixels
};

/// Side of the largest blocks, four at most, that leave eight to a sphere of diameter a [px].
int mirror_blocks(double diameter);

/// The kept calibration, or one of this film (calibrate_film), and the bias (bias_of_film).
///
/// **Blocks of pixels.** What mirror images leave of discs sets the error of a position, and does
/// not fall with resolution. So films on which the general correction holds are fitted by blocks of
/// f × f pixels, the mean of each. f is the largest, four at most, that leaves eight blocks to a
/// true diameter a: the least of the cameras that the correction was learned from. f = 2 takes half
/// of the time, and positions err as much or 5 % more (docs/tracking/binning.md). Other films lose
/// accuracy, and are fitted pixel by pixel: a is unknown, a first fit leaves less than twice the
/// noise or has edges wider than .15 a, no correction is wanted or holds, or a part needs pixels
/// (needs_pixels). Where it is seen late that the correction does not hold, the film is calibrated
/// again. A number as `track.binning` overrules all this. A kept calibration is of its own blocks,
/// with a warning where the correction does not hold.
///
/// `options`: consistent (require_consistent). What was decided goes into `plan`. Throws
/// OptionError where track.binning leaves fewer than 32 blocks across a frame, and what
/// bias_of_film and use_kept throw.
FilmModel model_of_film(FrameSource& source, const TrackOptions& options, int threads,
                        RunPlan& plan);

}  // namespace grainfield::tracking
