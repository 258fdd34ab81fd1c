#include "tracking/layers/sphere_cell.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace grainfield::tracking {
namespace {

constexpr double kContact = 1 - 1e-6;  // [a]

}  // namespace

double rise_at(double distance) {
    return distance < kContact ? std::sqrt((1 - distance) * (1 + distance)) : 0;
}

bool three_fit(double one, double other, double third, double slack) {
    return one + other + third - std::max({one, other, third}) <= slack;
}

bool has_room(const SphereCell& cell, Vec2 place, const std::vector<Vec2>& neighbours,
              double granted) {
    const auto rise = [&](Vec2 a, Vec2 b) {
        return rise_at(norm(a - b) / cell.diameter + granted);
    };
    std::vector<double> rises;
    for (const Vec2 p : neighbours) rises.push_back(rise(place, p));
    for (std::size_t i = 0; i < rises.size(); ++i) {
        if (rises[i] > cell.slack()) return false;
        for (std::size_t k = 0; k < i; ++k) {
            const double third = rise(neighbours[i], neighbours[k]);
            if (rises[i] <= 0 || rises[k] <= 0 || third <= 0) continue;
            if (!three_fit(rises[i], rises[k], third, cell.slack())) return false;
        }
    }
    return true;
}

}  // namespace grainfield::tracking
