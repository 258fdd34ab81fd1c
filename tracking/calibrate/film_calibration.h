#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/frame_source.h"
#include "core/run_plan.h"
#include "tracking/calibrate/calibration.h"
#include "tracking/calibrate/kept_calibration.h"
#include "tracking/model/visible_pixels.h"

namespace grainfield::tracking {

/// What all frames of a film are measured with, and how it was found.
struct FilmCalibration {
    std::optional<Calibration> calibration = {};  ///< empty: no frame could be calibrated on
    std::int64_t frame = -1;  ///< index of the frame whose spheres are the positions; −1: none
    std::vector<SizeCandidate> weighed =
        {};                       ///< on the frame at weighed_at, or on the last one tried
    std::int64_t weighed_at = 0;  ///< position of a frame among those selected
};

/// Estimates on the first usable frame of ten that are spread over the film. What was decided, and
/// what is wrong with the frames that were tried, goes into `plan`.
FilmCalibration calibrate_film(FrameSource& source, const CalibrationOptions& calibration,
                               const DetectionOptions& detection,
                               const RefinementOptions& refinement, const VisiblePixels& visible,
                               int threads, RunPlan& plan);

/// Takes over what another film was measured with. Warns in `plan` where the first usable frame
/// does not fit it. Throws InputError if it is of frames of another size.
FilmCalibration use_kept(const KeptCalibration& kept, FrameSource& source,
                         const VisiblePixels& visible, int threads, RunPlan& plan);

/// What other films need to be measured alike, from the frame calibrated on. Call only with a
/// calibration.
KeptCalibration to_keep(const FilmCalibration& film, FrameSource& source,
                        const VisiblePixels& visible, int threads);

}  // namespace grainfield::tracking
