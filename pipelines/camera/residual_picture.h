#pragma once

#include <string>
#include <vector>

#include "tracking/camera/camera_fit.h"

namespace grainfield::pipelines {

/// The residual field of a fitted camera as SVG: the frame, an arrow from each point to where it
/// was found, enlarged so that the longest is a tenth of the frame, and beside it how far the
/// correction moves the points of a grid, in true size. `cell_view` is drawn in colour, the other
/// views in grey.
std::string residual_picture(const tracking::CameraFit& fit, std::size_t cell_view);

}  // namespace grainfield::pipelines
