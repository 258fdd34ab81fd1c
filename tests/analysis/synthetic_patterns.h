#pragma once

#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "analysis/pattern.h"
#include "core/support/random.h"
#include "core/trajectory.h"

/// Point patterns with known statistics, for the tests of the analysis.
namespace grainfield::analysis::synthetic {

inline Box square_box(double length, Boundary boundary = Boundary::periodic, Vec2 origin = {0, 0}) {
    return {origin, {length, length}, {boundary, boundary}, 0};
}

inline Pattern pattern(std::vector<Vec2> points, const Box& box, std::int64_t frame = 0) {
    Pattern p;
    p.frame = frame;
    p.time = static_cast<double>(frame);
    p.box = box;
    p.position = std::move(points);
    for (Vec2& r : p.position) r = box.wrap(r);
    return p;
}

/// n independent uniform points.
inline std::vector<Vec2> poisson_points(std::size_t n, const Box& box, RandomStream& random) {
    std::vector<Vec2> points(n);
    for (Vec2& p : points) {
        p = box.origin + Vec2{box.length.x * random.uniform(), box.length.y * random.uniform()};
    }
    return points;
}

/// m × m points of a square lattice of the given spacing, half a spacing off the corner, each moved
/// by a Gaussian of standard deviation `jitter` per axis.
inline std::vector<Vec2> square_lattice(int m, double spacing, double jitter,
                                        RandomStream& random) {
    std::vector<Vec2> points;
    for (int iy = 0; iy < m; ++iy) {
        for (int ix = 0; ix < m; ++ix) {
            const Vec2 shift{jitter > 0 ? jitter * random.normal() : 0,
                             jitter > 0 ? jitter * random.normal() : 0};
            points.push_back(Vec2{(ix + 0.5) * spacing, (iy + 0.5) * spacing} + shift);
        }
    }
    return points;
}

/// Snapshots in memory.
class MemorySource final : public SnapshotSource {
 public:
    TrajectoryInfo description;
    std::vector<Snapshot> snapshots;

    const TrajectoryInfo& info() const override { return description; }
    std::int64_t count() const override { return static_cast<std::int64_t>(snapshots.size()); }
    Snapshot read(std::int64_t index) override {
        return snapshots[static_cast<std::size_t>(index)];
    }
};

inline std::vector<std::int64_t> identities(std::size_t n) {
    std::vector<std::int64_t> id(n);
    std::iota(id.begin(), id.end(), std::int64_t{0});
    return id;
}

}  // namespace grainfield::analysis::synthetic
