#include "simulate/render/optics/mirror_cell.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"
#include <embree3/rtcore.h>
#pragma GCC diagnostic pop

#include "core/errors.h"
#include "simulate/render/optics/fresnel.h"

namespace grainfield::simulate {

namespace {

constexpr double radius = 0.5;
constexpr double glass_index = 1.52;
constexpr double least_weight = 0.01;
constexpr double half_ring = 2 * std::numbers::pi / 180;
constexpr std::uint32_t nothing = RTC_INVALID_GEOMETRY_ID;

RTCScene scene_of(RTCDevice device, const std::vector<Vec3>& centres) {
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    RTCGeometry spheres = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    if (!centres.empty()) {
        auto* data = static_cast<float*>(
            rtcSetNewGeometryBuffer(spheres, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                                    4 * sizeof(float), centres.size()));
        if (data == nullptr) throw Error("Embree has no memory for the spheres of a frame.");
        for (const Vec3 p : centres) {
            *data++ = static_cast<float>(p.x);
            *data++ = static_cast<float>(p.y);
            *data++ = static_cast<float>(p.z);
            *data++ = static_cast<float>(radius);
        }
    }
    rtcCommitGeometry(spheres);
    rtcAttachGeometry(scene, spheres);
    rtcReleaseGeometry(spheres);
    rtcCommitScene(scene);
    return scene;
}

}  // namespace

EmbreeDevice::EmbreeDevice() : handle_(rtcNewDevice("threads=1,set_affinity=0")) {
    if (handle_ == nullptr) throw Error("Embree cannot be started.");
}

EmbreeDevice::~EmbreeDevice() {
    rtcReleaseDevice(handle_);
}

MirrorCell::MirrorCell(const EmbreeDevice& device, std::span<const SphereScene> instants,
                       Vec2 middle, const RaytraceOptions& options)
    : instants_(instants),
      options_(options),
      middle_(middle),
      panel_(instants.front().low_plate - options.panel_distance),
      low_(instants.front().low_plate),
      high_(std::max(instants.front().high_plate, low_ + 1)),
      has_glass_(options.glass_thickness > 0),
      clear_(has_glass_ ? 1 - plate_reflectance(1) : 1) {
    for (const SphereScene& scene : instants) {
        for (const Vec3 p : scene.centre) {
            low_ = std::min(low_, p.z - radius);
            high_ = std::max(high_, p.z + radius);
        }
    }
    for (const SphereScene& scene : instants) {
        embree_.push_back(scene_of(device.handle(), scene.centre));
    }
}

MirrorCell::~MirrorCell() {
    for (RTCScene scene : embree_) rtcReleaseScene(scene);
}

double MirrorCell::panel(Vec3 origin, Vec3 direction) const {
    const double cosine = -direction.z;
    if (cosine < 1e-6) return 0;
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    // In air above and below the plate along the ray, within it as refracted.
    const double air = origin.z - panel_ - options_.glass_thickness;
    double reach = air / cosine * sine;
    double passes = 1;
    if (has_glass_) {
        const double inside = sine / glass_index;
        reach += options_.glass_thickness * inside / std::sqrt(1 - inside * inside);
        passes = (1 - plate_reflectance(cosine)) / clear_;
    }
    const double along = sine > 0 ? reach / sine : 0;
    const double x = origin.x + direction.x * along - middle_.x;
    const double y = origin.y + direction.y * along - middle_.y;
    if (std::max(std::abs(x), std::abs(y)) > options_.panel_half_size) return 0;
    return passes * std::pow(cosine, options_.emission_power - 1);
}

MirrorCell::Seen MirrorCell::look(const LightPath& ray, std::int64_t& rays) const {
    const std::uint32_t hit = first_sphere(ray, rays);
    if (hit == nothing) return {panel(ray.origin, ray.direction), false};
    return {reflected(ray, hit, 1, options_.bounces, rays), true};
}

std::uint32_t MirrorCell::first_sphere(const LightPath& ray, std::int64_t& rays) const {
    float nearest = ray.from == LightPath::no_sphere ? 0.0F : 1e-4F;
    for (;;) {
        ++rays;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRayHit query{};
        query.ray.org_x = static_cast<float>(ray.origin.x);
        query.ray.org_y = static_cast<float>(ray.origin.y);
        query.ray.org_z = static_cast<float>(ray.origin.z);
        query.ray.dir_x = static_cast<float>(ray.direction.x);
        query.ray.dir_y = static_cast<float>(ray.direction.y);
        query.ray.dir_z = static_cast<float>(ray.direction.z);
        query.ray.tnear = nearest;
        query.ray.tfar = std::numeric_limits<float>::infinity();
        query.ray.mask = ~0U;
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(embree_[static_cast<std::size_t>(ray.instant)], &context, &query);
        if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return nothing;
        // A mirror that curves outwards cannot see itself: rounding did.
        if (query.hit.primID != ray.from) return query.hit.primID;
        nearest = std::max(query.ray.tfar, nearest) + 1e-3F;
    }
}

// What comes along `ray` from the mirror that it hits.
double MirrorCell::reflected(const LightPath& ray, std::uint32_t sphere, double weight, int bounces,
                             std::int64_t& rays) const {
    const Vec3 centre = instants_[static_cast<std::size_t>(ray.instant)].centre[sphere];
    const Vec3 from = ray.origin - centre;
    const double along = dot(from, ray.direction);
    const double square = along * along - squared_norm(from) + radius * radius;
    const double t = -along - std::sqrt(std::max(0.0, square));
    const Vec3 outward = from + ray.direction * t;
    const Vec3 normal = outward * (1 / norm(outward));
    const double cosine = -dot(ray.direction, normal);
    if (cosine <= 0) return 0;
    const double share = options_.reflectivity ? schlick_reflectance(cosine, *options_.reflectivity)
                                               : metal_reflectance(cosine);
    if (bounces <= 0 || weight * share < least_weight) return 0;
    const LightPath on{centre + normal * radius, ray.direction + normal * (2 * cosine), ray.instant,
                       sphere};
    return share * follow(on, weight * share, bounces - 1, rays);
}

double MirrorCell::follow(const LightPath& ray, double weight, int bounces,
                          std::int64_t& rays) const {
    const std::uint32_t hit = options_.neighbours ? first_sphere(ray, rays) : nothing;
    if (hit != nothing) return reflected(ray, hit, weight, bounces, rays);
    const double cosine = std::abs(ray.direction.z);
    const double share = has_glass_ ? plate_reflectance(cosine) : 0;
    double radiance = 0;
    if (ray.direction.z < 0) {
        radiance = panel(ray.origin, ray.direction);
    } else if (options_.ring_level > 0) {
        const double angle = std::acos(std::min(1.0, cosine));
        const double ring = options_.ring_angle * std::numbers::pi / 180;
        if (std::abs(angle - ring) < half_ring) radiance = (1 - share) * options_.ring_level;
    }
    if (weight * share < least_weight || cosine < 1e-6 || bounces <= 0) {
        return radiance;
    }
    const double plate = ray.direction.z < 0 ? low_ : high_;
    const double t = (plate - ray.origin.z) / ray.direction.z;
    const LightPath back{ray.origin + ray.direction * t,
                         {ray.direction.x, ray.direction.y, -ray.direction.z},
                         ray.instant};
    return radiance + share * follow(back, weight * share, bounces - 1, rays);
}

}  // namespace grainfield::simulate
