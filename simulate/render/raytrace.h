#pragma once

#include <memory>

#include "simulate/render/optics.h"
#include "simulate/render/silhouette.h"

namespace grainfield::simulate {

/// Mirror-like steel spheres between two glass plates above a diffuse panel, ray by ray.
///
/// A ray from the camera that meets a sphere goes on as from a mirror, weakened by the reflectance
/// of steel (metal_reflectance); one that meets a plate is split into what passes and what the
/// plate reflects (plate_reflectance), as if at its inner face. What passes downwards sees the
/// panel, radiance ∝ cos^(power − 1) of its angle, within panel_half_size of the frame's middle,
/// after refraction in the glass; what passes upwards sees the LED ring (4° wide) or darkness.
/// Paths end after `bounces` mirrors or below 1 % of weight. Radiance is relative to the
/// unobstructed panel seen straight down. Neglected: roughness, polarisation along a path, the
/// ghost of the plates' outer faces being displaced, light that reaches the panel from spheres.
///
/// Sampling: pixels that no disc touches are the panel in closed form. Of all others one ray
/// through the middle is traced; where it agrees with those of the four neighbours, that is the
/// pixel. Elsewhere 4, 16, 64 … points of the R2 sequence (`roberts2018`) follow until two
/// estimates agree within `tolerance`. The share of the pixel that spheres cover comes from
/// SilhouetteOptics and is exact, so that samples only average over the covered part.
///
/// Intersections by Embree (`wald2014`), hit points and normals recomputed in double. Time is
/// about 0.3 µs a ray and core. Same bits for any number of threads.
class RaytraceOptics : public Optics {
 public:
    RaytraceOptics(const RaytraceOptions& options, int threads);
    ~RaytraceOptics() override;

    Image radiance(const SphereScene& scene, const View& view) override;
    OpticsCost cost() const override { return cost_; }

 private:
    struct Device;
    RaytraceOptions options_;
    int threads_;
    OpticsCost cost_;
    SilhouetteOptics silhouette_;
    std::unique_ptr<Device> device_;
};

}  // namespace grainfield::simulate
