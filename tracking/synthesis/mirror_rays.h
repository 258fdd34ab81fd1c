#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "tracking/synthesis/mirror_optics.h"
#include "tracking/synthesis/near_spheres.h"

namespace grainfield::tracking {

/// From (x, y, z) [a] along (dx, dy, dz), of length 1.
struct MirrorRay {
    float x, y, z, dx, dy, dz;
};

/// Cells one diameter wide, and the sphere nearest to the middle of each.
struct SphereGrid {
    const std::int32_t* middle;
    int columns, rows;
    float left, top;
    float lowest, highest;  ///< no sphere reaches beyond [a]

    /// A sphere close to a place; −1: none, or none that a ray can meet from there.
    std::int32_t at(float x, float y, float z) const {
        if (z < lowest || z > highest) return -1;
        const float u = std::floor(x - left);
        const float v = std::floor(y - top);
        if (u < 0 || v < 0 || u >= static_cast<float>(columns) || v >= static_cast<float>(rows)) {
            return -1;
        }
        return middle[static_cast<std::ptrdiff_t>(v) * columns + static_cast<std::ptrdiff_t>(u)];
    }
};

/// What the kernel needs of the scene.
struct MirrorLayer {
    const Point3* spheres;
    const NearSpheres* near;
    int reflections;
    SphereGrid grid;

    Point3 centre(std::int32_t id, const MovedSphere& moved) const {
        return id == moved.id ? moved.centre : spheres[id];
    }
};

/// Rays of the camera, side by side; whole vectors of lanes.
struct CameraRays {
    const float *x, *y, *dx, *dy, *dz;
};

/// What each of them meets first, and the spheres that it passes closely.
struct FirstOfRays {
    float* distance;
    std::int32_t* first;
    PassedSpheres* passed;  ///< null: not wanted
};

/// The light that comes along a path under one kind of optics.
struct PathLight {
    float reflectivity = 0, ambient = 0, grazing = 0;
    float weight = 1;

    PathLight() = default;
    PathLight(const MirrorOptics& optics)  // NOLINT(google-explicit-constructor)
        : reflectivity(static_cast<float>(optics.reflectivity)),
          ambient(static_cast<float>(optics.ambient)),
          grazing(static_cast<float>(optics.grazing)) {}

    /// A mirror met at an angle of which (1 − cos)⁵ is given.
    void mirror(float fifth) { weight *= reflectivity + (1 - reflectivity) * fifth; }
    void block() { weight = 0; }
    /// The path leaves the layer with this slope.
    void leave(float dz) { weight = dz < -grazing ? weight : weight * ambient; }
};

/// The light under several optics along one path.
struct PathLights {
    PathLight* light;
    std::size_t count;

    void mirror(float fifth) {
        for (std::size_t k = 0; k < count; ++k) light[k].mirror(fifth);
    }
    void block() {
        for (std::size_t k = 0; k < count; ++k) light[k].block();
    }
    void leave(float dz) {
        for (std::size_t k = 0; k < count; ++k) light[k].leave(dz);
    }
};

/// Follows a ray of the camera that meets `first` (−1: none) while nothing is moved, from mirror to
/// mirror, until it leaves the layer. Another sphere may be moved.
void light_along(const MirrorLayer& layer, const MirrorRay& ray, std::int32_t first,
                 const MovedSphere& moved, PathLight& light);
/// The same under several optics.
void lights_along(const MirrorLayer& layer, const MirrorRay& ray, std::int32_t first,
                  PathLights& lights);
/// The same, and what the ray touches.
void touching_light_along(const MirrorLayer& layer, const MirrorRay& ray, std::int32_t first,
                          TouchedSpheres& touched, PathLight& light);

/// The rays `begin` to `end` − 1 that meet a sphere about `c`, or pass it closely, are told so.
/// They begin at `from_height`.
void meet_sphere(const CameraRays& rays, int begin, int end, float from_height, const Point3& c,
                 std::int32_t id, FirstOfRays& found);

}  // namespace grainfield::tracking
