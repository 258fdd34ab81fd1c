#include "tests/support/slit_spheres.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/support/random.h"

namespace grainfield::testing {
namespace {

/// Cells of side a over the floor.
class FloorCells {
 public:
    explicit FloorCells(const SlitScene& scene)
        : columns_(static_cast<int>(scene.side) + 1),
          members_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(columns_)) {
        for (std::uint32_t i = 0; i < scene.position.size(); ++i) {
            members_[index(scene.position[i])].push_back(i);
        }
    }

    template <class Action>
    void near(Vec2 p, Action&& action) const {
        const int c = place(p.x);
        const int r = place(p.y);
        for (int y = std::max(0, r - 1); y <= std::min(columns_ - 1, r + 1); ++y) {
            for (int x = std::max(0, c - 1); x <= std::min(columns_ - 1, c + 1); ++x) {
                for (const auto j : members_[index(x, y)]) action(j);
            }
        }
    }

    void move(std::uint32_t i, Vec2 from, Vec2 to) {
        if (index(from) == index(to)) return;
        std::erase(members_[index(from)], i);
        members_[index(to)].push_back(i);
    }

 private:
    int place(double x) const { return std::clamp(static_cast<int>(x), 0, columns_ - 1); }
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
               static_cast<std::size_t>(x);
    }
    std::size_t index(Vec2 p) const { return index(place(p.x), place(p.y)); }

    int columns_;
    std::vector<std::vector<std::uint32_t>> members_;
};

double squared_distance(Vec2 p, double z, Vec2 q, double zq) {
    return squared_norm(p - q) + (z - zq) * (z - zq);
}

/// Checkerboard sites whose place passes `wanted`.
template <class Wanted>
void add_sites(SlitScene& scene, double spacing, Wanted&& wanted) {
    const int count = static_cast<int>((scene.side - 1) / spacing) + 1;
    for (int row = 0; row < count; ++row) {
        for (int column = 0; column < count; ++column) {
            const Vec2 p{0.5 + spacing * column, 0.5 + spacing * row};
            if (!wanted(p)) continue;
            scene.position.push_back(p);
            scene.z.push_back((row + column) % 2 == 0 ? 0 : scene.height - 1);
        }
    }
}

}  // namespace

void shake(SlitScene& scene, double step, int sweeps, std::uint64_t seed) {
    RandomStream random(seed, "slit spheres");
    FloorCells cells(scene);
    const double slack = scene.height - 1;
    const double far = scene.side - 0.5;
    for (int s = 0; s < sweeps; ++s) {
        for (std::uint32_t i = 0; i < scene.position.size(); ++i) {
            const Vec2 from = scene.position[i];
            const Vec2 to = from + Vec2{random.uniform(-step, step), random.uniform(-step, step)};
            const double z = scene.z[i] + random.uniform(-step, step);
            if (z < 0 || z > slack || to.x < 0.5 || to.y < 0.5 || to.x > far || to.y > far) {
                continue;
            }
            bool is_free = true;
            cells.near(to, [&](std::uint32_t j) {
                is_free = is_free &&
                          (j == i || squared_distance(to, z, scene.position[j], scene.z[j]) >= 1);
            });
            if (!is_free) continue;
            cells.move(i, from, to);
            scene.position[i] = to;
            scene.z[i] = z;
        }
    }
}

SlitScene shaken_bilayer(double side, double height, double spacing, double step, int sweeps,
                         std::uint64_t seed) {
    SlitScene scene{side, height, {}, {}};
    add_sites(scene, spacing, [](Vec2) { return true; });
    shake(scene, step, sweeps, seed);
    return scene;
}

SlitScene patch_in_liquid(double side, double height, double patch_radius, double patch_spacing,
                          double liquid_spacing, double step, int sweeps, std::uint64_t seed) {
    SlitScene scene{side, height, {}, {}};
    const Vec2 middle{side / 2, side / 2};
    const double edge = patch_radius + 1;
    add_sites(scene, liquid_spacing,
              [&](Vec2 p) { return squared_norm(p - middle) > edge * edge; });
    shake(scene, step, sweeps, seed);
    SlitScene patch{side, height, {}, {}};
    add_sites(patch, patch_spacing,
              [&](Vec2 p) { return squared_norm(p - middle) < patch_radius * patch_radius; });
    shake(patch, 0.02, 60, seed + 1);
    const FloorCells cells(scene);
    for (std::size_t i = 0; i < patch.position.size(); ++i) {
        bool is_free = true;
        cells.near(patch.position[i], [&](std::uint32_t j) {
            is_free = is_free && squared_distance(patch.position[i], patch.z[i], scene.position[j],
                                                  scene.z[j]) >= 1;
        });
        if (!is_free) continue;
        scene.position.push_back(patch.position[i]);
        scene.z.push_back(patch.z[i]);
    }
    return scene;
}

double closest_approach(const SlitScene& scene) {
    const FloorCells cells(scene);
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < scene.position.size(); ++i) {
        cells.near(scene.position[i], [&](std::uint32_t j) {
            if (j == i) return;
            least = std::min(least, squared_distance(scene.position[i], scene.z[i],
                                                     scene.position[j], scene.z[j]));
        });
    }
    return std::sqrt(least);
}

}  // namespace grainfield::testing
