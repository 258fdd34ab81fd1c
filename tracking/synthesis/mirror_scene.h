#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tracking/synthesis/mirror_optics.h"
#include "tracking/synthesis/near_spheres.h"

namespace grainfield::tracking {

/// What the rays of one row of the camera meet first.
struct FirstSpheres {
    std::vector<std::int32_t> first;  ///< −1: none
    /// Spheres that a ray passes within kTouch; empty where they are not wanted.
    std::vector<PassedSpheres> passed;
    std::vector<float> distance;  ///< of the first hit along each ray [a]
    std::vector<float> lanes;     ///< room of the kernel

    /// Those that ray k passes before it meets one.
    TouchedSpheres touched(std::size_t k) const {
        TouchedSpheres result;
        for (int n = 0; n < passed[k].count; ++n) {
            if (passed[k].along[n] < distance[k]) result.add(passed[k].id[n]);
        }
        return result;
    }
};

struct MirrorLayer;  // what the kernel reads

/// Mirror-like spheres of diameter 1 seen from above, ray by ray.
///
/// A ray that meets a sphere goes on as from a mirror, weakened by its reflectance, until it leaves
/// the layer. From one sphere to the next it is followed over 10 diameters in the plane.
/// Cost: about 0.1 µs a ray and core. Thread-safe while nothing is moved.
class MirrorScene {
 public:
    static constexpr std::size_t kMostOptics = 8;

    MirrorScene(std::vector<Point3> spheres, const MirrorOptics& optics);

    const std::vector<Point3>& spheres() const { return spheres_; }
    const MirrorOptics& optics() const { return optics_; }
    void set_optics(const MirrorOptics& optics) { optics_ = optics; }
    /// The spheres within NearSpheres::kReach of one of them.
    const NearSpheres& near(std::int32_t sphere) const {
        return near_[static_cast<std::size_t>(sphere)];
    }

    /// What the rays through (x, y, 0) meet first. `x` rises in equal steps.
    void first_spheres(const std::vector<float>& x, float y, bool wants_passed,
                       FirstSpheres& row) const;

    /// Radiance along the ray through (x, y, 0), which meets `first` first while nothing is moved;
    /// −1: none. With `moved` elsewhere.
    float radiance(float x, float y, std::int32_t first, const MovedSphere& moved = {}) const;
    /// The same, and what it touches, to which `touched` is added.
    float radiance(float x, float y, std::int32_t first, TouchedSpheres& touched) const;
    /// The same under each of at most kMostOptics optics, whose cameras and reflections must
    /// be those of optics().
    void radiances(float x, float y, std::int32_t first, std::span<const MirrorOptics> optics,
                   std::span<float> radiance) const;

 private:
    MirrorLayer layer() const;
    void find_middles();
    template <class Action>
    void each_near(float x, float y, float distance, Action&& action) const;

    std::vector<Point3> spheres_;
    MirrorOptics optics_;
    std::vector<NearSpheres> near_;
    int columns_ = 0, rows_ = 0;  ///< of cells one diameter wide
    float left_ = 0, top_ = 0;
    std::vector<std::int32_t> begin_, member_;
    std::vector<std::int32_t> middle_;  ///< of each cell the sphere nearest to its middle, −1: none
    float lowest_ = 1e9F, highest_ = -1e9F;  ///< no sphere reaches beyond [a]
};

}  // namespace grainfield::tracking
