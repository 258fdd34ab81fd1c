#pragma once

namespace grainfield::tracking {

/// A point or displacement in space [a]; x, y as in the image, z towards the camera.
struct Point3 {
    float x = 0, y = 0, z = 0;
};

/// How mirror-like spheres over a bright panel are lit and seen. Radiance is relative to the
/// unobstructed panel.
///
/// Reflectance is F(c) = F0 + (1 − F0)(1 − c)⁵ (`schlick1994`), c the cosine of the angle of
/// incidence. A path that leaves the layer downwards and steeper than `grazing` sees the panel;
/// any other sees `ambient`. The camera looks down from `distance` diameters, 0: from infinity,
/// above `middle`. A Gaussian of standard deviation `blur` spreads each point.
struct MirrorOptics {
    double reflectivity = 0.65;  ///< F0 [-]
    double blur = 0.07;          ///< [a]
    double ambient = 0.04;       ///< radiance of what is not the panel [-]
    double grazing = 0.2;        ///< sine of the least angle below the horizon that meets the panel
    double distance = 0;         ///< of the camera from the plane z = 0 [a]; 0: telecentric
    double middle_x = 0, middle_y = 0;  ///< what the camera looks down on [a]
    int reflections = 6;                ///< most mirrors on a path

    friend bool operator==(const MirrorOptics&, const MirrorOptics&) = default;
};

/// Standard errors of what a frame says of MirrorOptics; 0: not known.
struct OpticsErrors {
    double reflectivity = 0, blur = 0, ambient = 0, grazing = 0;

    friend bool operator==(const OpticsErrors&, const OpticsErrors&) = default;
};

}  // namespace grainfield::tracking
