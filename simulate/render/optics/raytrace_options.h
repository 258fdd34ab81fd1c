#pragma once

#include <optional>

namespace grainfield::simulate {

/// Steel spheres between glass plates over a panel. Section `raytrace`.
struct RaytraceOptions {
    double panel_distance = 20;   ///< of the diffuser below the low plate's upper face [a]
    double panel_half_size = 75;  ///< of the square panel [a]
    double emission_power = 1;    ///< panel radiance ∝ cos^(power − 1): 1 is Lambertian
    double glass_thickness = 10;  ///< of either plate [a]; 0: no plates
    /// Of a sphere met straight on, growing to 1 at grazing incidence (schlick_reflectance) [-];
    /// auto: iron (metal_reflectance).
    std::optional<double> reflectivity;
    double ring_level = 0;   ///< radiance of an LED ring above / of the panel; 0: none
    double ring_angle = 30;  ///< of the ring from the vertical, as seen from the cell [deg]
    int bounces = 4;         ///< mirror reflections followed
    bool neighbours = true;  ///< spheres mirror one another; else each only panel and ring
    int most_samples = 16;   ///< rays from the camera per pixel, at most
    /// Twice the standard deviation around a pixel for which one more ray is spent, where it is
    /// bright [bright field]; 0: no ray is spared; auto: of the camera's noise
    /// (sampling_tolerance).
    std::optional<double> tolerance;
};

/// The tolerance of ray tracing: as given, else in proportion to `noise`, the variance of the noise
/// of the camera's bright field / its square. The error of sampling goes as the root of it and so
/// follows the noise until most_samples or pixels with a single ray limit it.
double sampling_tolerance(const RaytraceOptions& options, double noise);

}  // namespace grainfield::simulate
