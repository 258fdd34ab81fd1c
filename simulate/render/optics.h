#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/frame.h"
#include "core/vec3.h"
#include "simulate/render/render_options.h"
#include "simulate/render/view.h"

namespace grainfield::simulate {

/// Spheres of diameter 1 between two plates, at one instant. Lengths in a.
struct SphereScene {
    std::vector<Vec3> centre;
    double low_plate = 0;  ///< height of its upper face
    double high_plate = 0;
};

/// What the images so far took.
struct OpticsCost {
    double pixels = 0;
    double settled = 0;       ///< pixels that were decided without tracing a ray
    double rays = 0;          ///< rays traced, reflected ones included; 0 where there are none
    double samples = 0;       ///< of these, rays that start in the camera
    double uniform_rays = 0;  ///< an estimate: with as many samples in every pixel
};

/// Forms images of spheres: each pixel is the mean, over its square, of the radiance relative to
/// the unobstructed backlight (1 bright, 0 black), in focus, and over the instants of an exposure.
/// Illumination, blur and noise are the camera's.
class Optics {
 public:
    virtual ~Optics() = default;

    /// `instants`: one or more, of the same spheres in the same order. Same scenes and view → same
    /// bits, for any number of threads. Spheres outside the view are allowed; those beside it may
    /// still reflect into it.
    virtual Image radiance(std::span<const SphereScene> instants, const View& view) = 0;
    Image radiance(const SphereScene& scene, const View& view) {
        return radiance({&scene, 1}, view);
    }
    virtual OpticsCost cost() const = 0;
};

/// The optics that `options.optics` names.
std::unique_ptr<Optics> make_optics(const RenderOptions& options, int threads);

}  // namespace grainfield::simulate
