#include "tracking/synthesis/mirror_rays.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tracking/synthesis/mirror_rays.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace grainfield::tracking::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, 16>;
using IntTag = hn::RebindToSigned<FloatTag>;

constexpr float kFar = 1e9F;
constexpr float kSquaredRadius = 0.25F;
/// Of spheres that a ray meets within this distance of a sphere in the plane, all are near it [a].
constexpr float kComplete = NearSpheres::kReach - 0.5F - PassedSpheres::kTouch;
/// (R + δ)² − R² for δ = kTouch.
constexpr float kBeside = PassedSpheres::kTouch * (1 + PassedSpheres::kTouch);
constexpr int kMostHops = 5;  // a ray is followed 2 a farther by each
constexpr float kLeastSlope = 1e-9F;

struct Hit {
    std::int32_t id = -1;
    float distance = kFar;
};

/// The first of `near` that the ray meets, and with kTellsTouched those that it passes closely
/// before.
template <bool kTellsTouched>
HWY_INLINE Hit nearest_hit(const NearSpheres& near, const MirrorRay& ray, const MovedSphere& moved,
                           Hit best, TouchedSpheres* touched) {
    const FloatTag tag;
    const IntTag integers;
    const int lanes = static_cast<int>(hn::Lanes(tag));
    const auto px = hn::Set(tag, ray.x);
    const auto py = hn::Set(tag, ray.y);
    const auto pz = hn::Set(tag, ray.z);
    const auto dx = hn::Set(tag, ray.dx);
    const auto dy = hn::Set(tag, ray.dy);
    const auto dz = hn::Set(tag, ray.dz);
    const auto zero = hn::Zero(tag);
    const auto squared_radius = hn::Set(tag, kSquaredRadius);
    const auto moved_id = hn::Set(integers, moved.id);
    const auto moved_x = hn::Set(tag, moved.centre.x);
    const auto moved_y = hn::Set(tag, moved.centre.y);
    const auto moved_z = hn::Set(tag, moved.centre.z);
    HWY_ALIGN float closest[NearSpheres::kMost];
    HWY_ALIGN float beside[NearSpheres::kMost];
    auto least = hn::Set(tag, best.distance);
    auto which = hn::Set(integers, -1);
    for (int k = 0; k < near.count; k += lanes) {
        const auto id = hn::LoadU(integers, near.id + k);
        auto x = hn::LoadU(tag, near.x + k);
        auto y = hn::LoadU(tag, near.y + k);
        auto z = hn::LoadU(tag, near.z + k);
        if constexpr (!kTellsTouched) {
            const auto is_moved = hn::RebindMask(tag, hn::Eq(id, moved_id));
            x = hn::IfThenElse(is_moved, moved_x, x);
            y = hn::IfThenElse(is_moved, moved_y, y);
            z = hn::IfThenElse(is_moved, moved_z, z);
        }
        const auto ox = hn::Sub(x, px);
        const auto oy = hn::Sub(y, py);
        const auto oz = hn::Sub(z, pz);
        const auto along = hn::MulAdd(ox, dx, hn::MulAdd(oy, dy, hn::Mul(oz, dz)));
        const auto square = hn::MulAdd(ox, ox, hn::MulAdd(oy, oy, hn::Mul(oz, oz)));
        // Squared distance of ray and surface from the axis, R² − ρ².
        const auto inside = hn::Sub(squared_radius, hn::NegMulAdd(along, along, square));
        const auto meets = hn::And(hn::Gt(along, zero), hn::Gt(inside, zero));
        const auto distance = hn::Sub(along, hn::Sqrt(hn::Max(inside, zero)));
        const auto is_nearer = hn::And(meets, hn::Lt(distance, least));
        least = hn::IfThenElse(is_nearer, distance, least);
        which = hn::IfThenElse(hn::RebindMask(integers, is_nearer), id, which);
        if constexpr (kTellsTouched) {
            hn::Store(along, tag, closest + k);
            hn::Store(inside, tag, beside + k);
        }
    }
    const auto smallest = hn::MinOfLanes(tag, least);
    const float distance = hn::GetLane(smallest);
    if (distance < best.distance) {
        HWY_ALIGN std::int32_t ids[16];
        hn::Store(which, integers, ids);
        best = {ids[hn::FindFirstTrue(tag, hn::Eq(least, smallest))], distance};
    }
    if constexpr (kTellsTouched) {
        for (int k = 0; k < near.count; k += lanes) {
            const auto along = hn::Load(tag, closest + k);
            const auto inside = hn::Load(tag, beside + k);
            const auto is_passed =
                hn::And(hn::And(hn::Gt(along, zero), hn::Lt(along, hn::Set(tag, best.distance))),
                        hn::And(hn::Le(inside, zero), hn::Gt(inside, hn::Set(tag, -kBeside))));
            if (hn::AllFalse(tag, is_passed)) continue;
            for (int l = k; l < k + lanes; ++l) {
                if (closest[l] > 0 && closest[l] < best.distance && beside[l] <= 0 &&
                    beside[l] > -kBeside && near.id[l] >= 0) {
                    touched->add(near.id[l]);
                }
            }
        }
    }
    return best;
}

/// Where a ray meets one sphere.
HWY_INLINE Hit own_hit(const Point3& c, const MirrorRay& ray, std::int32_t id) {
    const float ox = c.x - ray.x;
    const float oy = c.y - ray.y;
    const float oz = c.z - ray.z;
    const float along = ox * ray.dx + oy * ray.dy + oz * ray.dz;
    const float inside = kSquaredRadius - (ox * ox + oy * oy + oz * oz - along * along);
    if (along > 0 && inside > 0) return {id, along - std::sqrt(inside)};
    return {};
}

/// What a ray that begins on the sphere `from` meets first. Where it leaves the circle about that
/// sphere within which all have been looked at, those near the sphere next to that place are.
template <bool kTellsTouched>
HWY_INLINE Hit first_hit(const MirrorLayer& layer, const MirrorRay& ray, std::int32_t from,
                         const MovedSphere& moved, TouchedSpheres* touched) {
    Hit hit = nearest_hit<kTellsTouched>(layer.near[from], ray, moved, {}, touched);
    const float flat = std::max(ray.dx * ray.dx + ray.dy * ray.dy, kLeastSlope);
    for (int hop = 0; hop < kMostHops && hit.id < 0; ++hop) {
        const Point3& c = layer.spheres[from];
        const float ox = ray.x - c.x;
        const float oy = ray.y - c.y;
        const float back = ox * ray.dx + oy * ray.dy;
        const float squared = back * back + flat * (kComplete * kComplete - ox * ox - oy * oy);
        if (squared <= 0) break;
        const float t = (std::sqrt(squared) - back) / flat;
        const std::int32_t next =
            layer.grid.at(ray.x + t * ray.dx, ray.y + t * ray.dy, ray.z + t * ray.dz);
        if (next < 0 || next == from) break;
        hit = nearest_hit<kTellsTouched>(layer.near[next], ray, moved,
                                         own_hit(layer.centre(next, moved), ray, next), touched);
        from = next;
    }
    return hit;
}

/// What a ray of the camera meets, if it met `first` (−1: none) while nothing was moved.
HWY_INLINE Hit camera_hit(const MirrorLayer& layer, const MirrorRay& ray, std::int32_t first,
                          const MovedSphere& moved) {
    if (first == moved.id) {  // what is behind may come to light
        return nearest_hit<false>(layer.near[first], ray, moved,
                                  own_hit(moved.centre, ray, moved.id), nullptr);
    }
    Hit hit;
    if (first >= 0) hit = own_hit(layer.spheres[first], ray, first);
    if (moved.id < 0) return hit;
    const Hit other = own_hit(moved.centre, ray, moved.id);
    return other.distance < hit.distance ? other : hit;
}

/// Along a ray of the camera that meets `first` while nothing is moved.
template <bool kTellsTouched, class Light>
HWY_INLINE void follow(const MirrorLayer& layer, MirrorRay ray, std::int32_t first,
                       const MovedSphere& moved, TouchedSpheres* touched, Light& light) {
    Hit hit = camera_hit(layer, ray, first, moved);
    if (hit.id < 0) return;  // the panel itself
    for (int n = 0; n < layer.reflections; ++n) {
        if (hit.id < 0) {
            light.leave(ray.dz);
            return;
        }
        if constexpr (kTellsTouched) touched->add(hit.id);
        ray.x += hit.distance * ray.dx;
        ray.y += hit.distance * ray.dy;
        ray.z += hit.distance * ray.dz;
        const Point3 c = layer.centre(hit.id, moved);
        const float nx = 2 * (ray.x - c.x);
        const float ny = 2 * (ray.y - c.y);
        const float nz = 2 * (ray.z - c.z);
        const float cosine = -(ray.dx * nx + ray.dy * ny + ray.dz * nz);
        if (cosine <= 0) {  // spheres that overlap: the ray began inside
            light.block();
            return;
        }
        const float grazing = 1 - std::min(cosine, 1.0F);
        const float squared = grazing * grazing;
        light.mirror(squared * squared * grazing);
        ray.dx += 2 * cosine * nx;
        ray.dy += 2 * cosine * ny;
        ray.dz += 2 * cosine * nz;
        hit = first_hit<kTellsTouched>(layer, ray, hit.id, moved, touched);
    }
    if (hit.id >= 0) {
        light.block();
    } else {
        light.leave(ray.dz);
    }
}

void light_along(const MirrorLayer& layer, const MirrorRay& ray, std::int32_t first,
                 const MovedSphere& moved, PathLight& light) {
    follow<false>(layer, ray, first, moved, nullptr, light);
}

void lights_along(const MirrorLayer& layer, const MirrorRay& ray, std::int32_t first,
                  PathLights& lights) {
    follow<false>(layer, ray, first, {}, nullptr, lights);
}

void touching_light_along(const MirrorLayer& layer, const MirrorRay& ray, std::int32_t first,
                          TouchedSpheres& touched, PathLight& light) {
    follow<true>(layer, ray, first, {}, &touched, light);
}

/// The rays `begin` to `end` − 1 that meet a sphere, or pass it closely, are told so.
void meet_sphere(const CameraRays& rays, int begin, int end, float from_height, const Point3& c,
                 std::int32_t id, FirstOfRays& found) {
    const FloatTag tag;
    const IntTag integers;
    const int lanes = static_cast<int>(hn::Lanes(tag));
    const auto oz = hn::Set(tag, c.z - from_height);
    const auto squared_radius = hn::Set(tag, kSquaredRadius);
    for (int k = begin / lanes * lanes; k < end; k += lanes) {
        const auto ox = hn::Sub(hn::Set(tag, c.x), hn::LoadU(tag, rays.x + k));
        const auto oy = hn::Sub(hn::Set(tag, c.y), hn::LoadU(tag, rays.y + k));
        const auto along = hn::MulAdd(
            ox, hn::LoadU(tag, rays.dx + k),
            hn::MulAdd(oy, hn::LoadU(tag, rays.dy + k), hn::Mul(oz, hn::LoadU(tag, rays.dz + k))));
        const auto square = hn::MulAdd(ox, ox, hn::MulAdd(oy, oy, hn::Mul(oz, oz)));
        const auto inside = hn::Sub(squared_radius, hn::NegMulAdd(along, along, square));
        const auto distance = hn::Sub(along, hn::Sqrt(hn::Max(inside, hn::Zero(tag))));
        const auto least = hn::LoadU(tag, found.distance + k);
        const auto is_first = hn::And(hn::Gt(inside, hn::Zero(tag)), hn::Lt(distance, least));
        hn::StoreU(hn::IfThenElse(is_first, distance, least), tag, found.distance + k);
        hn::StoreU(hn::IfThenElse(hn::RebindMask(integers, is_first), hn::Set(integers, id),
                                  hn::LoadU(integers, found.first + k)),
                   integers, found.first + k);
        if (found.passed == nullptr) continue;
        const auto is_passed =
            hn::And(hn::Le(inside, hn::Zero(tag)), hn::Gt(inside, hn::Set(tag, -kBeside)));
        if (hn::AllFalse(tag, is_passed)) continue;
        HWY_ALIGN float at[16];
        HWY_ALIGN float margin[16];
        hn::Store(along, tag, at);
        hn::Store(inside, tag, margin);
        for (int l = 0; l < lanes; ++l) {
            if (margin[l] <= 0 && margin[l] > -kBeside) found.passed[k + l].add(id, at[l]);
        }
    }
}

}  // namespace grainfield::tracking::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainfield::tracking {

HWY_EXPORT(light_along);
HWY_EXPORT(lights_along);
HWY_EXPORT(touching_light_along);
HWY_EXPORT(meet_sphere);

void light_along(const MirrorLayer& layer, const MirrorRay& ray, std::int32_t first,
                 const MovedSphere& moved, PathLight& light) {
    HWY_DYNAMIC_DISPATCH(light_along)(layer, ray, first, moved, light);
}

void lights_along(const MirrorLayer& layer, const MirrorRay& ray, std::int32_t first,
                  PathLights& lights) {
    HWY_DYNAMIC_DISPATCH(lights_along)(layer, ray, first, lights);
}

void touching_light_along(const MirrorLayer& layer, const MirrorRay& ray, std::int32_t first,
                          TouchedSpheres& touched, PathLight& light) {
    HWY_DYNAMIC_DISPATCH(touching_light_along)(layer, ray, first, touched, light);
}

void meet_sphere(const CameraRays& rays, int begin, int end, float from_height, const Point3& c,
                 std::int32_t id, FirstOfRays& found) {
    HWY_DYNAMIC_DISPATCH(meet_sphere)(rays, begin, end, from_height, c, id, found);
}

}  // namespace grainfield::tracking
#endif
