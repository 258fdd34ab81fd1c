#include "tracking/synthesis/mirror_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "tracking/synthesis/mirror_rays.h"

namespace grainfield::tracking {
namespace {

constexpr float kStart = 3;  // [a] above the plane z = 0: rays begin above all spheres
constexpr int kLanes = 16;
constexpr float kNowhere = 1e6F;  // [a]
constexpr float kSeen = 0.5F + PassedSpheres::kTouch;
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
        each_near(p.x, p.y, NearSpheres::kReach, [&](std::int32_t j, float squared) {
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
        meet_sphere(rays, column(c.x - reach), column(c.x + reach) + 1, kStart, c, j, found);
    }
}

float MirrorScene::radiance(float x, float y, std::int32_t first, const MovedSphere& moved) const {
    PathLight light(optics_);
    light_along(layer(), camera_ray(optics_, x, y), first, moved, light);
    return light.weight;
}

float MirrorScene::radiance(float x, float y, std::int32_t first, TouchedSpheres& touched) const {
    PathLight light(optics_);
    touching_light_along(layer(), camera_ray(optics_, x, y), first, touched, light);
    return light.weight;
}

void MirrorScene::radiances(float x, float y, std::int32_t first,
                            std::span<const MirrorOptics> optics, std::span<float> radiance) const {
    std::array<PathLight, kMostOptics> light;
    std::copy(optics.begin(), optics.end(), light.begin());
    PathLights lights{light.data(), optics.size()};
    lights_along(layer(), camera_ray(optics_, x, y), first, lights);
    for (std::size_t k = 0; k < optics.size(); ++k) radiance[k] = light[k].weight;
}

}  // namespace grainfield::tracking
