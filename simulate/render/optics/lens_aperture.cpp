#include "simulate/render/optics/lens_aperture.h"

#include <cmath>
#include <numbers>

namespace grainfield::simulate {

namespace {

constexpr int points_of_a_lens = 12;

}  // namespace

std::vector<Vec2> lens_points(double aperture) {
    if (aperture <= 0) return {Vec2{}};
    constexpr double golden_angle = std::numbers::pi * (3 - 2.23606797749978969);
    std::vector<Vec2> points;
    for (int j = 0; j < points_of_a_lens; ++j) {
        const double slope = std::tan(aperture) * std::sqrt((j + 0.5) / points_of_a_lens);
        points.push_back({slope * std::cos(j * golden_angle), slope * std::sin(j * golden_angle)});
    }
    return points;
}

SphereScene seen_through(const SphereScene& scene, Vec2 point, const View& view) {
    SphereScene seen = scene;
    for (Vec3& p : seen.centre) {
        const double below = view.mid_height() - p.z;
        p = p + Vec3{point.x * below, point.y * below, 0};
    }
    return seen;
}

}  // namespace grainfield::simulate
