#include "tracking/synthesis/mirror_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#ifndef GRAINFIELD_MIRROR_LAYER
#define GRAINFIELD_MIRROR_LAYER
namespace grainfield::tracking {

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

}  // namespace grainfield::tracking
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tracking/synthesis/mirror_scene.cpp"
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
constexpr float kComplete = MirrorScene::kReach - 0.5F - MirrorScene::kTouch;
/// (R + δ)² − R² for δ = kTouch.
constexpr float kBeside = MirrorScene::kTouch * (1 + MirrorScene::kTouch);
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
namespace {

HWY_EXPORT(light_along);
HWY_EXPORT(lights_along);
HWY_EXPORT(touching_light_along);
HWY_EXPORT(meet_sphere);

constexpr float kStart = 3;  // [a] above the plane z = 0: rays begin above all spheres
constexpr int kLanes = 16;
constexpr float kNowhere = 1e6F;  // [a]
constexpr float kSeen = 0.5F + MirrorScene::kTouch;
constexpr float kSquaredRadius = 0.25F;
// A sphere's own radius, and how far one may be moved [a].
constexpr float kHighest = 0.75F;

/// The ray of the camera through (x, y, 0).
MirrorRay camera_ray(const MirrorOptics& optics, float x, float y) {
    if (!(optics.distance > 0)) return {x, y, kStart, 0, 0, -1};
    const float across = x - static_cast<float>(optics.middle_x);
    const float down = y - static_cast<float>(optics.middle_y);
    const auto far = static_cast<float>(optics.distance);
    const float length = std::sqrt(across * across + down * down + far * far);
    const float dx = across / length;
    const float dy = down / length;
    const float dz = -far / length;
    const float back = kStart / dz;
    return {x + back * dx, y + back * dy, kStart, dx, dy, dz};
}

}  // namespace

MirrorLayer MirrorScene::layer() const {
    return {spheres_.data(),
            near_.data(),
            optics_.reflections,
            {middle_.data(), columns_, rows_, left_, top_, lowest_, highest_}};
}

MirrorScene::MirrorScene(std::vector<Point3> spheres, const MirrorOptics& optics)
    : spheres_(std::move(spheres)), optics_(optics), near_(spheres_.size()) {
    float right = 0;
    float bottom = 0;
    for (const Point3& p : spheres_) {
        left_ = std::min(left_, p.x);
        top_ = std::min(top_, p.y);
        right = std::max(right, p.x);
        bottom = std::max(bottom, p.y);
    }
    columns_ = static_cast<int>(right - left_) + 1;
    rows_ = static_cast<int>(bottom - top_) + 1;
    const auto cell = [&](const Point3& p) {
        return static_cast<std::size_t>(p.y - top_) * static_cast<std::size_t>(columns_) +
               static_cast<std::size_t>(p.x - left_);
    };
    begin_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
    for (const Point3& p : spheres_) ++begin_[cell(p) + 1];
    for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
    member_.resize(spheres_.size());
    std::vector<std::int32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t i = 0; i < spheres_.size(); ++i) {
        member_[static_cast<std::size_t>(next[cell(spheres_[i])]++)] = static_cast<std::int32_t>(i);
    }
    find_middles();
    std::vector<std::pair<float, std::int32_t>> found;
    for (std::size_t i = 0; i < spheres_.size(); ++i) {
        const Point3 p = spheres_[i];
        found.clear();
        each_near(p.x, p.y, kReach, [&](std::int32_t j, float squared) {
            if (j != static_cast<std::int32_t>(i)) found.emplace_back(squared, j);
        });
        std::sort(found.begin(), found.end());
        NearSpheres& near = near_[i];
        const auto most = std::min<std::size_t>(found.size(), NearSpheres::kMost);
        near.count = static_cast<int>((most + kLanes - 1) / kLanes * kLanes);
        for (std::size_t k = 0; k < static_cast<std::size_t>(near.count); ++k) {
            const bool is_there = k < most;
            const Point3 q = is_there ? spheres_[static_cast<std::size_t>(found[k].second)]
                                      : Point3{kNowhere, kNowhere, kNowhere};
            near.x[k] = q.x;
            near.y[k] = q.y;
            near.z[k] = q.z;
            near.id[k] = is_there ? found[k].second : -1;
        }
    }
}

void MirrorScene::find_middles() {
    for (const Point3& p : spheres_) {
        lowest_ = std::min(lowest_, p.z - kHighest);
        highest_ = std::max(highest_, p.z + kHighest);
    }
    middle_.assign(begin_.size() - 1, -1);
    for (int v = 0; v < rows_; ++v) {
        for (int u = 0; u < columns_; ++u) {
            std::int32_t& middle =
                middle_[static_cast<std::size_t>(v) * static_cast<std::size_t>(columns_) +
                        static_cast<std::size_t>(u)];
            float least = 2;
            each_near(left_ + static_cast<float>(u) + 0.5F, top_ + static_cast<float>(v) + 0.5F, 1,
                      [&](std::int32_t j, float squared) {
                          if (squared >= least) return;
                          least = squared;
                          middle = j;
                      });
        }
    }
}

template <class Action>
void MirrorScene::each_near(float x, float y, float distance, Action&& action) const {
    const auto column = [&](float v) {
        return std::clamp(static_cast<int>(std::floor(v - left_)), 0, columns_ - 1);
    };
    const auto row = [&](float v) {
        return std::clamp(static_cast<int>(std::floor(v - top_)), 0, rows_ - 1);
    };
    for (int v = row(y - distance); v <= row(y + distance); ++v) {
        for (int u = column(x - distance); u <= column(x + distance); ++u) {
            const auto c = static_cast<std::size_t>(v) * static_cast<std::size_t>(columns_) +
                           static_cast<std::size_t>(u);
            for (std::int32_t k = begin_[c]; k < begin_[c + 1]; ++k) {
                const std::int32_t j = member_[static_cast<std::size_t>(k)];
                const Point3& q = spheres_[static_cast<std::size_t>(j)];
                const float squared = (q.x - x) * (q.x - x) + (q.y - y) * (q.y - y);
                if (squared < distance * distance) action(j, squared);
            }
        }
    }
}

void MirrorScene::first_spheres(const std::vector<float>& x, float y, bool wants_passed,
                                FirstSpheres& row) const {
    const std::size_t count = (x.size() + kLanes - 1) / kLanes * kLanes;
    row.first.assign(count, -1);
    row.passed.assign(wants_passed ? count : 0, {});
    row.distance.assign(count, kNowhere);
    if (x.empty()) return;
    std::vector<float>& lanes = row.lanes;
    lanes.assign(5 * count, kNowhere);
    float* part[5];
    for (std::size_t k = 0; k < 5; ++k) part[k] = lanes.data() + k * count;
    float across = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        const MirrorRay ray = camera_ray(optics_, x[k], y);
        part[0][k] = ray.x;
        part[1][k] = ray.y;
        part[2][k] = ray.dx;
        part[3][k] = ray.dy;
        part[4][k] = ray.dz;
        if (optics_.distance > 0) {
            across = std::max(across, kStart * std::hypot(ray.dx, ray.dy) / -ray.dz);
        }
    }
    const CameraRays rays{part[0], part[1], part[2], part[3], part[4]};
    FirstOfRays found{row.distance.data(), row.first.data(),
                      wants_passed ? row.passed.data() : nullptr};
    const float reach = kSeen + across;
    const auto row_of = [&](float v) {
        return std::clamp(static_cast<int>(std::floor(v - top_)), 0, rows_ - 1);
    };
    const auto cells = [&](int v) {
        return static_cast<std::size_t>(v) * static_cast<std::size_t>(columns_);
    };
    const float left = x.front();
    const float per_step =
        x.size() > 1 ? static_cast<float>(x.size() - 1) / (x.back() - left) : 1.0F;
    for (std::int32_t m = begin_[cells(row_of(y - reach))];
         m < begin_[cells(row_of(y + reach) + 1)]; ++m) {
        const std::int32_t j = member_[static_cast<std::size_t>(m)];
        const Point3& c = spheres_[static_cast<std::size_t>(j)];
        if (std::abs(c.y - y) > reach || c.x + reach < left || c.x - reach > x.back()) continue;
        const auto column = [&](float at) {
            return std::clamp(static_cast<int>((at - left) * per_step), 0,
                              static_cast<int>(x.size()) - 1);
        };
        HWY_DYNAMIC_DISPATCH(meet_sphere)
        (rays, column(c.x - reach), column(c.x + reach) + 1, kStart, c, j, found);
    }
}

float MirrorScene::radiance(float x, float y, std::int32_t first, const MovedSphere& moved) const {
    PathLight light(optics_);
    HWY_DYNAMIC_DISPATCH(light_along)(layer(), camera_ray(optics_, x, y), first, moved, light);
    return light.weight;
}

float MirrorScene::radiance(float x, float y, std::int32_t first, TouchedSpheres& touched) const {
    PathLight light(optics_);
    HWY_DYNAMIC_DISPATCH(touching_light_along)
    (layer(), camera_ray(optics_, x, y), first, touched, light);
    return light.weight;
}

void MirrorScene::radiances(float x, float y, std::int32_t first,
                            std::span<const MirrorOptics> optics, std::span<float> radiance) const {
    std::array<PathLight, kMostOptics> light;
    std::copy(optics.begin(), optics.end(), light.begin());
    PathLights lights{light.data(), optics.size()};
    HWY_DYNAMIC_DISPATCH(lights_along)(layer(), camera_ray(optics_, x, y), first, lights);
    for (std::size_t k = 0; k < optics.size(); ++k) radiance[k] = light[k].weight;
}

}  // namespace grainfield::tracking
#endif
