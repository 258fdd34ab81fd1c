#include "pipelines/camera/stored_camera.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

namespace grainfield::pipelines {

namespace {

using tracking::Camera;
using tracking::PlaneUnit;

constexpr const char* kName = "camera";
constexpr int kLargestFrame = 1 << 24;

/// Calls `visit(name, unit, meaning, field)` for every number that a trajectory keeps.
template <class Of, class Visit>
void each_number(Of& camera, const Visit& visit) {
    visit("focal", "px", "Focal length", camera.lens.focal);
    visit("centre_x", "px", "Centre of the lens, x", camera.lens.centre.x);
    visit("centre_y", "px", "Centre of the lens, y", camera.lens.centre.y);
    visit("k1", "-", "Radial distortion, r²", camera.lens.k1);
    visit("k2", "-", "Radial distortion, r⁴", camera.lens.k2);
    visit("p1", "-", "Tangential distortion", camera.lens.p1);
    visit("p2", "-", "Tangential distortion", camera.lens.p2);
    for (std::size_t i = 0; i < camera.homography.size(); ++i) {
        const std::string name = fmt::format("h{}{}", i / 3 + 1, i % 3 + 1);
        visit(name.c_str(), "-", "Homography to corrected px", camera.homography[i]);
    }
    visit("residual", "px", "Residual (RMS, per axis)", camera.residual_rms);
}

}  // namespace

Curve curve_of(const Camera& camera) {
    Curve curve{kName, "Lens and tilt that positions are corrected for", {}, {}};
    const auto add = [&](const char* name, const char* unit, const char* meaning, double value) {
        curve.columns.push_back({name, unit, meaning, {value}});
    };
    add("width", "px", "Width of the frames", camera.width);
    add("height", "px", "Height of the frames", camera.height);
    each_number(camera, add);
    if (camera.scale && camera.scale->unit == PlaneUnit::mm) {
        add("mm_per_px", "mm", "One corrected px", camera.scale->length);
    }
    return curve;
}

std::optional<Camera> stored_camera(const std::vector<Curve>& curves) {
    const auto found = std::ranges::find(curves, kName, &Curve::name);
    if (found == curves.end()) return std::nullopt;
    bool is_whole = true;
    const auto read = [&](const char* name, const char*, const char*, double& value) {
        const Column* column = found->find(name);
        is_whole = is_whole && column != nullptr && column->values.size() == 1 &&
                   std::isfinite(column->values.front());
        if (is_whole) value = column->values.front();
    };
    double width = 0;
    double height = 0;
    Camera camera;
    read("width", "", "", width);
    read("height", "", "", height);
    each_number(camera, read);
    if (!is_whole || !(width >= 1 && width <= kLargestFrame) ||
        !(height >= 1 && height <= kLargestFrame)) {
        return std::nullopt;
    }
    camera.width = static_cast<int>(width);
    camera.height = static_cast<int>(height);
    if (!tracking::fault_of(camera).empty()) return std::nullopt;
    return camera;
}

}  // namespace grainfield::pipelines
