#pragma once

#include <cstdint>
#include <vector>

#include "core/support/random.h"
#include "core/vec2.h"

namespace grainfield::analysis {

/// The same points for every benchmark of S(k): uniform in a square from 0 to `side` [a].
inline std::vector<Vec2> uniform_points(std::int64_t particles, double side) {
    RandomStream random(1, "uniform points");
    std::vector<Vec2> points(static_cast<std::size_t>(particles));
    for (Vec2& p : points) p = {side * random.uniform(), side * random.uniform()};
    return points;
}

}  // namespace grainfield::analysis
