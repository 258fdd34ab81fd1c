#include "tracking/synthesis/arrangement_search.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tracking/synthesis/rendered_layer.h"

namespace grainfield::tracking {
namespace {

using testing::rendered_layer;
using testing::RenderedLayer;

constexpr double kScale = 12;  // [px/a]

double in_plane(const Point3& a, const Point3& b) {
    return std::hypot(static_cast<double>(a.x - b.x), static_cast<double>(a.y - b.y));
}

/// The sphere nearest to the middle of those for which `suits` holds.
template <class Suits>
std::size_t near_middle(const RenderedLayer& layer, Suits suits) {
    const auto middle = static_cast<float>(0.5 * layer.brightness.width() / kScale);
    std::size_t nearest = layer.spheres.size();
    double least = 1e9;
    for (std::size_t i = 0; i < layer.spheres.size(); ++i) {
        const double d = in_plane(layer.spheres[i], {middle, middle, 0});
        if (d >= least || !suits(i)) continue;
        least = d;
        nearest = i;
    }
    return nearest;
}

/// One of the other layer that overlaps this one in projection; none: the number of spheres.
std::size_t crossing(const RenderedLayer& layer, std::size_t i) {
    const Point3& p = layer.spheres[i];
    for (std::size_t j = 0; j < layer.spheres.size(); ++j) {
        const Point3& q = layer.spheres[j];
        if (j != i && std::abs(p.z - q.z) > 0.5F && in_plane(p, q) < 0.8) return j;
    }
    return layer.spheres.size();
}

/// Fits from a wrong start, searches once, and fits again.
std::vector<Point3> improved(const RenderedLayer& layer, const std::vector<Point3>& start,
                             ArrangementChanges& changes) {
    const SynthesisLimits limits{.height = layer.height, .most_rounds = 3};
    SynthesisFit fit(layer.brightness, layer.ceiling, kScale, 2);
    fit.start(start, layer.optics);
    fit.refine(limits);
    std::vector<Point3> spheres;
    changes = improve_arrangement(layer.brightness, layer.ceiling, fit, start, kScale, limits, 2,
                                  spheres);
    fit.start(spheres, layer.optics);
    fit.refine(limits);
    return fit.spheres();
}

/// Spheres a diameter or more within the frame: what lies at its edge is seen in part.
std::ptrdiff_t inner(const RenderedLayer& layer, const std::vector<Point3>& spheres) {
    return std::ranges::count_if(spheres, [&](const Point3& p) { return layer.is_inner(p, 1); });
}

/// Distance of the nearest sphere found in the plane, and its height off [a].
std::pair<double, double> nearest_to(const Point3& p, const std::vector<Point3>& found) {
    std::pair<double, double> nearest{1e9, 0};
    for (const Point3& q : found) {
        const double d = in_plane(p, q);
        if (d < nearest.first) nearest = {d, static_cast<double>(std::abs(q.z - p.z))};
    }
    return nearest;
}

TEST(ArrangementSearch, ASphereMissingFromTheStartIsPutBack) {
    const RenderedLayer layer = rendered_layer(10, kScale, 0.01, 31);
    const std::size_t lost = near_middle(layer, [](std::size_t) { return true; });
    std::vector<Point3> start = layer.spheres;
    start.erase(start.begin() + static_cast<std::ptrdiff_t>(lost));
    ArrangementChanges changes;
    const std::vector<Point3> found = improved(layer, start, changes);
    EXPECT_EQ(inner(layer, found), inner(layer, layer.spheres));
    EXPECT_GE(changes.added, 1);
    const auto [off, height_off] = nearest_to(layer.spheres[lost], found);
    EXPECT_LT(off, 0.05);
    EXPECT_LT(height_off, 0.2);
}

TEST(ArrangementSearch, AFalseSphereIsTakenOut) {
    const RenderedLayer layer = rendered_layer(10, kScale, 0.01, 32);
    const std::size_t near = near_middle(layer, [](std::size_t) { return true; });
    std::vector<Point3> start = layer.spheres;
    const Point3 p = start[near];
    start.push_back({p.x + 0.35F, p.y + 0.2F, p.z > 0.47F ? 0.05F : 0.9F});
    ArrangementChanges changes;
    const std::vector<Point3> found = improved(layer, start, changes);
    EXPECT_EQ(inner(layer, found), inner(layer, layer.spheres));
    EXPECT_GE(changes.removed, 1);
}

TEST(ArrangementSearch, TwoSpheresWithTheirHeightsSwappedAreMended) {
    const RenderedLayer layer = rendered_layer(10, kScale, 0.01, 33);
    const std::size_t none = layer.spheres.size();
    const std::size_t one =
        near_middle(layer, [&](std::size_t i) { return crossing(layer, i) < none; });
    ASSERT_LT(one, none);
    const std::size_t other = crossing(layer, one);
    std::vector<Point3> start = layer.spheres;
    std::swap(start[one].z, start[other].z);
    ArrangementChanges changes;
    const std::vector<Point3> found = improved(layer, start, changes);
    EXPECT_EQ(inner(layer, found), inner(layer, layer.spheres));
    for (const std::size_t i : {one, other}) {
        const auto [off, height_off] = nearest_to(layer.spheres[i], found);
        EXPECT_LT(off, 0.05);
        EXPECT_LT(height_off, 0.15);
    }
}

TEST(ArrangementSearch, NothingChangesWhereRenderingAndImageAgree) {
    const RenderedLayer layer = rendered_layer(9, kScale, 0.01, 34);
    SynthesisFit fit(layer.brightness, layer.ceiling, kScale, 2);
    fit.start(layer.spheres, layer.optics);
    std::vector<Point3> spheres;
    const ArrangementChanges changes =
        improve_arrangement(layer.brightness, layer.ceiling, fit, layer.spheres, kScale,
                            {.height = layer.height}, 2, spheres);
    EXPECT_EQ(changes.added + changes.removed + changes.lifted, 0);
    EXPECT_EQ(spheres.size(), layer.spheres.size());
}

}  // namespace
}  // namespace grainfield::tracking
