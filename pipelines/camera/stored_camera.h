#pragma once

#include <optional>
#include <vector>

#include "core/results.h"
#include "tracking/camera/camera.h"

namespace grainfield::pipelines {

/// A camera as the file of a trajectory holds it: one row, a column a number.
Curve curve_of(const tracking::Camera& camera);

/// The camera that positions were corrected with, from the curves of a trajectory; empty if they
/// were not, or if what is there is no camera.
std::optional<tracking::Camera> stored_camera(const std::vector<Curve>& curves);

}  // namespace grainfield::pipelines
