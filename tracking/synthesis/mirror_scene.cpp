#include "tracking/synthesis/mirror_scene.h"

#include <algorithm>
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
    float reflectivity, ambient, grazing;
    int reflections;
    SphereGrid grid;

    Point3 centre(std::int32_t id, const MovedSphere& moved) const {
        return id == moved.id ? moved.centre : spheres[id];
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
constexpr int kMostHops = 5;  // a ray is followed 2 a farther by each
constexpr float kLeastSlope = 1e-9F;

struct Hit {
    std::int32_t id = -1;
    float distance = kFar;
};

/// The first of `near` that the ray meets, and with kTouch those that it passes closely before.
template <bool kTouch>
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
        if constexpr (!kTouch) {
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
        if constexpr (kTouch) {
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
    if constexpr (kTouch) {
        // (R + δ)² − R² for δ = kTouch.
        constexpr float kBeside = MirrorScene::kTouch * (1 + MirrorScene::kTouch);
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
template <bool kTouch>
HWY_INLINE Hit first_hit(const MirrorLayer& layer, const MirrorRay& ray, std::int32_t from,
                         const MovedSphere& moved, TouchedSpheres* touched) {
    Hit hit = nearest_hit<kTouch>(layer.near[from], ray, moved, {}, touched);
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
        hit = nearest_hit<kTouch>(layer.near[next], ray, moved,
                                  own_hit(layer.centre(next, moved), ray, next), touched);
        from = next;
    }
    return hit;
}

/// Along a ray of the camera that meets `first` or one near it.
template <bool kTouch>
HWY_INLINE float follow(const MirrorLayer& layer, MirrorRay ray, std::int32_t first,
                        const MovedSphere& moved, TouchedSpheres* touched) {
    // The first sphere itself is not among those near it.
    Hit hit = nearest_hit<kTouch>(layer.near[first], ray, moved,
                                  own_hit(layer.centre(first, moved), ray, first), touched);
    float weight = 1;
    for (int n = 0; n < layer.reflections; ++n) {
        if (hit.id < 0) {
            if (n == 0) return 1;  // the panel itself
            return ray.dz < -layer.grazing ? weight : weight * layer.ambient;
        }
        if constexpr (kTouch) touched->add(hit.id);
        ray.x += hit.distance * ray.dx;
        ray.y += hit.distance * ray.dy;
        ray.z += hit.distance * ray.dz;
        const Point3 c = layer.centre(hit.id, moved);
        const float nx = 2 * (ray.x - c.x);
        const float ny = 2 * (ray.y - c.y);
        const float nz = 2 * (ray.z - c.z);
        const float cosine = -(ray.dx * nx + ray.dy * ny + ray.dz * nz);
        // Spheres that overlap: the ray began inside.
        if (cosine <= 0) return 0;
        const float grazing = 1 - std::min(cosine, 1.0F);
        const float squared = grazing * grazing;
        weight *= layer.reflectivity + (1 - layer.reflectivity) * squared * squared * grazing;
        ray.dx += 2 * cosine * nx;
        ray.dy += 2 * cosine * ny;
        ray.dz += 2 * cosine * nz;
        hit = first_hit<kTouch>(layer, ray, hit.id, moved, touched);
    }
    if (hit.id >= 0) return 0;
    return ray.dz < -layer.grazing ? weight : weight * layer.ambient;
}

float radiance_along(const MirrorLayer& layer, const MirrorRay& ray, std::int32_t first,
                     const MovedSphere& moved) {
    return follow<false>(layer, ray, first, moved, nullptr);
}

float touching_radiance_along(const MirrorLayer& layer, const MirrorRay& ray, std::int32_t first,
                              TouchedSpheres& touched) {
    return follow<true>(layer, ray, first, {}, &touched);
}

}  // namespace grainfield::tracking::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainfield::tracking {
namespace {

HWY_EXPORT(radiance_along);
HWY_EXPORT(touching_radiance_along);

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
            static_cast<float>(optics_.reflectivity),
            static_cast<float>(optics_.ambient),
            static_cast<float>(optics_.grazing),
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

std::int32_t MirrorScene::first_sphere(float x, float y, std::int32_t& beside) const {
    const MirrorRay ray = camera_ray(optics_, x, y);
    beside = -1;
    // A ray is inclined by less than 45°.
    const float across = optics_.distance > 0 ? kStart * std::hypot(ray.dx, ray.dy) / -ray.dz : 0;
    std::int32_t first = -1;
    float least = 2 * kStart;
    each_near(x, y, kSeen + across, [&](std::int32_t j, float) {
        const Point3& c = spheres_[static_cast<std::size_t>(j)];
        const float ox = c.x - ray.x;
        const float oy = c.y - ray.y;
        const float oz = c.z - ray.z;
        const float along = ox * ray.dx + oy * ray.dy + oz * ray.dz;
        const float inside = kSquaredRadius - (ox * ox + oy * oy + oz * oz - along * along);
        if (inside <= 0) {
            beside = j;
            return;
        }
        const float distance = along - std::sqrt(inside);
        if (distance < least) {
            least = distance;
            first = j;
        }
    });
    return first;
}

float MirrorScene::radiance(float x, float y, std::int32_t first, const MovedSphere& moved) const {
    if (first < 0) return 1;
    return HWY_DYNAMIC_DISPATCH(radiance_along)(layer(), camera_ray(optics_, x, y), first, moved);
}

float MirrorScene::radiance(float x, float y, std::int32_t first, TouchedSpheres& touched) const {
    if (first < 0) return 1;
    return HWY_DYNAMIC_DISPATCH(touching_radiance_along)(layer(), camera_ray(optics_, x, y), first,
                                                         touched);
}

}  // namespace grainfield::tracking
#endif
