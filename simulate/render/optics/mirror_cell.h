#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/vec2.h"
#include "core/vec3.h"
#include "simulate/render/optics/optics.h"
#include "simulate/render/optics/raytrace_options.h"

struct RTCDeviceTy;
struct RTCSceneTy;

namespace grainfield::simulate {

/// Embree, started once for all cells. Throws Error if it cannot be.
class EmbreeDevice {
 public:
    EmbreeDevice();
    ~EmbreeDevice();
    EmbreeDevice(const EmbreeDevice&) = delete;
    EmbreeDevice& operator=(const EmbreeDevice&) = delete;
    RTCDeviceTy* handle() const { return handle_; }

 private:
    RTCDeviceTy* handle_;
};

/// A half-line on which light is followed backwards.
struct LightPath {
    static constexpr std::uint32_t no_sphere = ~0U;
    Vec3 origin;
    Vec3 direction;                  ///< of length 1
    int instant = 0;                 ///< which of the instants it sees
    std::uint32_t from = no_sphere;  ///< the sphere that it leaves
};

/// Mirror spheres between two glass plates above a panel: what a ray sees (RaytraceOptics says
/// which physics). The spheres may be at several instants of one exposure. Every ray belongs to one
/// of them and sees that alone, in a bounding volume hierarchy of its own. Safe for many threads.
class MirrorCell {
 public:
    /// `instants`: the same spheres in the same order; outlive this, as do `device` and `options`.
    /// `middle`: of the panel [a].
    MirrorCell(const EmbreeDevice& device, std::span<const SphereScene> instants, Vec2 middle,
               const RaytraceOptions& options);
    ~MirrorCell();
    MirrorCell(const MirrorCell&) = delete;
    MirrorCell& operator=(const MirrorCell&) = delete;

    int instants() const { return static_cast<int>(instants_.size()); }
    double top() const { return high_; }  ///< above all spheres [a]

    struct Seen {
        double radiance = 0;
        bool sphere = false;  ///< the first thing met
    };
    /// Adds the number of rays traced to `rays`.
    Seen look(const LightPath& ray, std::int64_t& rays) const;
    /// What a ray sees that meets no sphere on its way down: the panel, reached through air and
    /// the plate of thickness d at a distance across of (h − d) tan θ + d sin θ/sqrt(n² − sin²θ), h
    /// its height above the panel.
    double panel(Vec3 origin, Vec3 direction) const;

 private:
    std::uint32_t first_sphere(const LightPath& ray, std::int64_t& rays) const;
    double reflected(const LightPath& ray, std::uint32_t sphere, double weight, int bounces,
                     std::int64_t& rays) const;
    double follow(const LightPath& ray, double weight, int bounces, std::int64_t& rays) const;

    std::span<const SphereScene> instants_;
    const RaytraceOptions& options_;
    Vec2 middle_;
    std::vector<RTCSceneTy*> embree_;  // one an instant
    double panel_;                     // height of the panel
    double low_;
    double high_;
    bool has_glass_;
    double clear_;  // what the low plate lets through, seen straight
};

}  // namespace grainfield::simulate
