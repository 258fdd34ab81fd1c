#pragma once

#include <cstdint>

#include "core/trajectory.h"
#include "simulate/render/motion/grain_motion.h"
#include "simulate/render/projection.h"
#include "simulate/render/render_options.h"

namespace grainfield::simulate {

/// What adaptive sampling costs in accuracy, measured on a patch. Relative to the bright field.
struct SamplingCheck {
    int size = 0;           ///< side of the patch [px]; 0: nothing to compare
    double difference = 0;  ///< RMS difference from uniform sampling
    double noise = 0;       ///< RMS noise of the camera on that patch
    double rays = 0;        ///< a pixel of the patch
    double saved = 0;       ///< of the rays of uniform sampling with as many samples [-]
};

/// Ray-traces the middle of the frame twice, as `options` say and with 32 samples in every pixel
/// and no adaptive sampling, both after blur and without noise, and compares the two. `view`: of
/// the whole frame; `series`: as for Renderer::render. A second or two. Nothing for silhouettes,
/// which are exact.
SamplingCheck check_sampling(const RenderOptions& options, const View& view,
                             const TrajectoryInfo& info, const SnapshotSeries& series,
                             std::uint64_t seed, int threads);

}  // namespace grainfield::simulate
