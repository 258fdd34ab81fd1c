#pragma once

#include "core/frame_source.h"
#include "core/run_plan.h"
#include "tracking/calibrate/film_calibration.h"
#include "tracking/film_bias.h"
#include "tracking/track_options.h"

namespace grainfield::tracking {

/// What all frames of a film are fitted with, and what their positions are corrected with.
struct FilmModel {
    FilmCalibration film;  ///< of pixels, or of blocks of them (ImageModel::binning)
    FilmBias bias;         ///< undecided where nothing could be calibrated
};

/// Side of the largest blocks that leave eight to a sphere of diameter a [px]; 1: none do.
int mirror_blocks(double diameter);

/// The kept calibration, or one of this film (calibrate_film), and the bias (bias_of_film).
///
/// **Blocks of pixels.** The error of a position has two parts. Noise tells on every pixel. What
/// mirror images leave of discs does not fall with resolution. So films on which the general
/// correction holds are fitted by blocks of f × f pixels, the mean of each: the time falls by half
/// for f = 2. f is the largest that leaves eight blocks to a true diameter a, the least of the
/// cameras that the correction was learned from. Positions of 51 cameras err by 6 % more, and
/// nothing more is missed (docs/tracking/binning.md). Other films lose more, and are fitted pixel by
/// pixel: a is unknown, noise is more than half of what discs leave, no correction is wanted or
/// holds, or a part needs pixels (needs_pixels). Where it is seen late that the correction does not
/// hold, the film is calibrated again. `track.binning` overrules all this.
///
/// `options`: consistent (require_consistent). What was decided goes into `plan`. Throws what
/// bias_of_film and use_kept throw.
FilmModel model_of_film(FrameSource& source, const TrackOptions& options, int threads,
                        RunPlan& plan);

}  // namespace grainfield::tracking
