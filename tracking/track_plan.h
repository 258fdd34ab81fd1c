#pragma once

#include <cstdint>

#include "core/box.h"
#include "core/run_plan.h"
#include "tracking/camera/camera.h"
#include "tracking/model/image_model.h"
#include "tracking/track_options.h"

namespace grainfield::tracking {

/// Says how each of `count` frames is searched, fitted and linked.
void plan_frames(const ImageModel& model, const TrackOptions& options, std::int64_t count,
                 RunPlan& plan);

/// Says that positions are corrected for lens and tilt, and what is left of frames of that size.
void plan_camera(const CameraMap& camera, const Box& box, int width, int height, RunPlan& plan);

/// Says where heights and layers come from, or why there are none.
void plan_heights(const TrackOptions& options, RunPlan& plan);

}  // namespace grainfield::tracking
