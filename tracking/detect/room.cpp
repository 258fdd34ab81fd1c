#include "tracking/detect/room.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace grainfield::tracking {
namespace {

double rise(const SphereCell& cell, Vec2 a, Vec2 b, double granted) {
    const double d = std::min(1.0, norm(a - b) / cell.diameter + granted);
    return std::sqrt(1 - d * d);
}

}  // namespace

bool has_room(const SphereCell& cell, Vec2 place, const std::vector<Vec2>& neighbours,
              double granted) {
    std::vector<double> rises;
    for (const Vec2 p : neighbours) rises.push_back(rise(cell, place, p, granted));
    for (std::size_t i = 0; i < rises.size(); ++i) {
        if (rises[i] > cell.slack()) return false;
        for (std::size_t k = 0; k < i; ++k) {
            const double third = rise(cell, neighbours[i], neighbours[k], granted);
            if (rises[i] <= 0 || rises[k] <= 0 || third <= 0) continue;
            const double largest = std::max({rises[i], rises[k], third});
            if (rises[i] + rises[k] + third - largest > cell.slack()) return false;
        }
    }
    return true;
}

}  // namespace grainfield::tracking
