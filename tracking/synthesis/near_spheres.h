#pragma once

#include <cstdint>

#include "tracking/synthesis/mirror_optics.h"

namespace grainfield::tracking {

/// The spheres about one sphere, as the kernel reads them: whole vectors of lanes.
struct NearSpheres {
    static constexpr int kMost = 64;
    static constexpr float kReach = 2.5F;  ///< in the plane [a]
    int count = 0;                         ///< lanes in use, a multiple of 16
    float x[kMost], y[kMost], z[kMost];
    std::int32_t id[kMost];  ///< −1: no sphere
};

/// Spheres whose displacement by a small amount can change what one ray sees.
struct TouchedSpheres {
    static constexpr int kMost = 24;
    int count = 0;
    std::int32_t id[kMost];

    void add(std::int32_t sphere) {
        for (int k = 0; k < count; ++k) {
            if (id[k] == sphere) return;
        }
        if (count < kMost) id[count++] = sphere;
    }
};

/// Spheres that a ray of the camera passes closely, and where along the ray.
struct PassedSpheres {
    static constexpr int kMost = 4;
    /// A ray that passes a sphere nearer than this touches it [a].
    static constexpr float kTouch = 0.035F;
    int count = 0;
    std::int32_t id[kMost];
    float along[kMost];  ///< [a]

    void add(std::int32_t sphere, float at) {
        if (count == kMost) return;
        id[count] = sphere;
        along[count++] = at;
    }
};

/// A sphere that is looked at elsewhere than where it is.
struct MovedSphere {
    std::int32_t id = -2;  ///< none; −1 is a lane of NearSpheres without a sphere
    Point3 centre;
};

}  // namespace grainfield::tracking
