#include "simulate/render/raytrace.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"
#include <embree3/rtcore.h>
#pragma GCC diagnostic pop

#include "core/errors.h"
#include "core/parallel.h"
#include "simulate/render/fresnel.h"

namespace grainfield::simulate {

namespace {

constexpr double radius = 0.5;
constexpr double glass_index = 1.52;
constexpr double least_weight = 0.01;
constexpr double half_ring = 2 * std::numbers::pi / 180;
constexpr std::uint32_t nothing = RTC_INVALID_GEOMETRY_ID;

struct Ray {
    Vec3 origin;
    Vec3 direction;
    std::uint32_t from = nothing;  // the sphere that it leaves
};

/// The spheres and what surrounds them.
class Cell {
 public:
    Cell(RTCDevice device, const SphereScene& scene, const View& view,
         const RaytraceOptions& options)
        : scene_(scene), options_(options), middle_(view.centre()) {
        low_ = scene.low_plate;
        high_ = std::max(scene.high_plate, low_ + 1);
        for (const Vec3 p : scene.centre) {
            low_ = std::min(low_, p.z - radius);
            high_ = std::max(high_, p.z + radius);
        }
        has_glass_ = options.glass_thickness > 0;
        clear_ = has_glass_ ? 1 - plate_reflectance(1) : 1;
        embree_ = rtcNewScene(device);
        RTCGeometry spheres = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
        if (!scene.centre.empty()) {
            auto* data = static_cast<float*>(
                rtcSetNewGeometryBuffer(spheres, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                                        4 * sizeof(float), scene.centre.size()));
            for (const Vec3 p : scene.centre) {
                *data++ = static_cast<float>(p.x);
                *data++ = static_cast<float>(p.y);
                *data++ = static_cast<float>(p.z);
                *data++ = static_cast<float>(radius);
            }
        }
        rtcCommitGeometry(spheres);
        rtcAttachGeometry(embree_, spheres);
        rtcReleaseGeometry(spheres);
        rtcCommitScene(embree_);
    }
    ~Cell() { rtcReleaseScene(embree_); }
    Cell(const Cell&) = delete;
    Cell& operator=(const Cell&) = delete;

    double top() const { return high_; }

    /// What a ray sees that meets no sphere on its way down.
    double panel(Vec3 origin, Vec3 direction) const {
        const double cosine = -direction.z;
        if (cosine < 1e-6) return 0;
        const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
        double reach = (origin.z - low_ + options_.panel_distance) / cosine * sine;
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

    struct Seen {
        double radiance = 0;
        bool sphere = false;  // the first thing met
    };
    Seen look(Ray ray, std::int64_t& rays) const {
        const std::uint32_t hit = first_sphere(ray, rays);
        if (hit == nothing) return {panel(ray.origin, ray.direction), false};
        return {reflected(ray, hit, 1, options_.bounces, rays), true};
    }

 private:
    std::uint32_t first_sphere(const Ray& ray, std::int64_t& rays) const {
        float nearest = ray.from == nothing ? 0.0F : 1e-4F;
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
            rtcIntersect1(embree_, &context, &query);
            if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return nothing;
            // A mirror that curves outwards cannot see itself: rounding did.
            if (query.hit.primID != ray.from) return query.hit.primID;
            nearest = std::max(query.ray.tfar, nearest) + 1e-3F;
        }
    }

    // What comes along `ray` from the mirror that it hits.
    double reflected(const Ray& ray, std::uint32_t sphere, double weight, int bounces,
                     std::int64_t& rays) const {
        const Vec3 centre = scene_.centre[sphere];
        const Vec3 from = ray.origin - centre;
        const double along = dot(from, ray.direction);
        const double square = along * along - squared_norm(from) + radius * radius;
        const double t = -along - std::sqrt(std::max(0.0, square));
        const Vec3 outward = from + ray.direction * t;
        const Vec3 normal = outward * (1 / norm(outward));
        const double cosine = -dot(ray.direction, normal);
        if (cosine <= 0) return 0;
        const double share = metal_reflectance(cosine);
        if (bounces <= 0 || weight * share < least_weight) return 0;
        const Ray on{centre + normal * radius, ray.direction + normal * (2 * cosine), sphere};
        return share * follow(on, weight * share, bounces - 1, rays);
    }

    double follow(const Ray& ray, double weight, int bounces, std::int64_t& rays) const {
        const std::uint32_t hit = first_sphere(ray, rays);
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
        if (weight * share < least_weight || cosine < 1e-6 || bounces <= 0) return radiance;
        const double plate = ray.direction.z < 0 ? low_ : high_;
        const double t = (plate - ray.origin.z) / ray.direction.z;
        const Ray back{ray.origin + ray.direction * t,
                       {ray.direction.x, ray.direction.y, -ray.direction.z}};
        return radiance + share * follow(back, weight * share, bounces - 1, rays);
    }

    const SphereScene& scene_;
    const RaytraceOptions& options_;
    Vec2 middle_;
    RTCScene embree_ = nullptr;
    double low_ = 0;
    double high_ = 1;
    bool has_glass_ = true;
    double clear_ = 1;
};

// Through `pixel`, from just above the spheres: single precision would not bear the true distance.
Ray camera_ray(const View& view, Vec2 pixel, double top) {
    const Vec3 origin = view.at_height(pixel, top);
    if (view.projection() == Projection::telecentric) return {origin, {0, 0, -1}};
    const double pinhole = view.mid_height() + view.distance();
    const Vec3 down{origin.x - view.centre().x, origin.y - view.centre().y, top - pinhole};
    return {origin, down * (1 / norm(down))};
}

// Point k of the R2 sequence, within ± 1/2, shifted differently in every pixel: the errors of
// neighbours are then unrelated, and the blur averages them.
Vec2 sub_pixel(int k, int column, int row) {
    constexpr double a = 0.7548776662466927;
    constexpr double b = 0.5698402909980532;
    const double x = 0.5 + a * (k + 1) + 0.8191725134 * column + 0.6710436067 * row;
    const double y = 0.5 + b * (k + 1) + 0.5497004779 * column + 0.8566748838 * row;
    return {x - std::floor(x) - 0.5, y - std::floor(y) - 0.5};
}

struct RowCost {
    std::int64_t rays = 0;
    std::int64_t samples = 0;
    std::int64_t settled = 0;
};

/// The passes over the pixels of one image.
class Picture {
 public:
    Picture(const Cell& cell, const View& view, const RaytraceOptions& options, Image open)
        : cell_(cell),
          view_(view),
          options_(options),
          open_(std::move(open)),
          pilot_(view.width(), view.height()) {}

    // One ray through the middle, or the panel.
    void probe(int y, RowCost& cost) {
        for (int x = 0; x < view_.width(); ++x) {
            const Ray ray = camera_ray(view_, at(x, y), cell_.top());
            if (open_(x, y) >= 1) {
                pilot_(x, y) = static_cast<float>(cell_.panel(ray.origin, ray.direction));
                ++cost.settled;
                continue;
            }
            ++cost.samples;
            pilot_(x, y) = static_cast<float>(cell_.look(ray, cost.rays).radiance);
        }
    }

    void settle(int y, Image& image, RowCost& cost) const {
        for (int x = 0; x < view_.width(); ++x) {
            image(x, y) = is_settled(x, y) ? pilot_(x, y) : sampled(x, y, cost);
        }
    }

 private:
    static Vec2 at(int x, int y) { return {static_cast<double>(x), static_cast<double>(y)}; }

    bool is_settled(int x, int y) const {
        if (open_(x, y) >= 1) return true;
        if (open_(x, y) > 0) return false;
        const auto limit = static_cast<float>(options_.tolerance);
        const float here = pilot_(x, y);
        const auto differs = [&](int i, int j) {
            if (i < 0 || j < 0 || i >= view_.width() || j >= view_.height()) return false;
            return std::abs(pilot_(i, j) - here) > limit;
        };
        return !differs(x - 1, y) && !differs(x + 1, y) && !differs(x, y - 1) && !differs(x, y + 1);
    }

    float sampled(int x, int y, RowCost& cost) const {
        double covered = 0;
        double free = 0;
        int hits = 0;
        int misses = 0;
        double last = -1;
        int k = 0;
        for (int count = 4;; count *= 4) {
            count = std::min(count, options_.most_samples);
            for (; k < count; ++k) {
                const Ray ray = camera_ray(view_, at(x, y) + sub_pixel(k, x, y), cell_.top());
                const Cell::Seen seen = cell_.look(ray, cost.rays);
                ++cost.samples;
                (seen.sphere ? covered : free) += seen.radiance;
                ++(seen.sphere ? hits : misses);
            }
            const double estimate = combined(x, y, covered, hits, free, misses);
            if (std::abs(estimate - last) < options_.tolerance || k >= options_.most_samples) {
                return static_cast<float>(estimate);
            }
            last = estimate;
        }
    }

    // The exact share of either kind, where both were seen.
    double combined(int x, int y, double covered, int hits, double free, int misses) const {
        if (hits == 0) return free / misses;
        if (misses == 0) {
            const Ray ray = camera_ray(view_, at(x, y), cell_.top());
            const double open = static_cast<double>(open_(x, y));
            return open * (open > 0 ? cell_.panel(ray.origin, ray.direction) : 0) +
                   (1 - open) * covered / hits;
        }
        const double open = static_cast<double>(open_(x, y));
        return open * free / misses + (1 - open) * covered / hits;
    }

    const Cell& cell_;
    const View& view_;
    const RaytraceOptions& options_;
    Image open_;
    Image pilot_;
};

}  // namespace

struct RaytraceOptics::Device {
    RTCDevice handle = rtcNewDevice("threads=1,set_affinity=0");
    Device() {
        if (handle == nullptr) throw Error("Embree cannot be started.");
    }
    ~Device() { rtcReleaseDevice(handle); }
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
};

RaytraceOptics::RaytraceOptics(const RaytraceOptions& options, int threads)
    : options_(options),
      threads_(threads),
      silhouette_({}, threads),
      device_(std::make_unique<Device>()) {}

RaytraceOptics::~RaytraceOptics() = default;

Image RaytraceOptics::radiance(const SphereScene& scene, const View& view) {
    const Cell cell(device_->handle, scene, view, options_);
    Picture picture(cell, view, options_, silhouette_.radiance(scene, view));
    Image image(view.width(), view.height());
    const auto rows = static_cast<std::size_t>(view.height());
    std::vector<RowCost> cost(rows);
    const auto each_row = [&](const auto& body) {
        parallel_for(view.height(), threads_, [&](std::int64_t y) {
            body(static_cast<int>(y), cost[static_cast<std::size_t>(y)]);
        });
    };
    each_row([&](int y, RowCost& row) { picture.probe(y, row); });
    each_row([&](int y, RowCost& row) { picture.settle(y, image, row); });
    cost_.pixels += static_cast<double>(image.size());
    for (const RowCost& row : cost) {
        cost_.rays += static_cast<double>(row.rays);
        cost_.samples += static_cast<double>(row.samples);
        cost_.settled += static_cast<double>(row.settled);
    }
    return image;
}

}  // namespace grainfield::simulate
