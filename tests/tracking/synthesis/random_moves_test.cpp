#include "tracking/synthesis/random_moves.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tracking/synthesis/rendered_layer.h"

namespace grainfield::tracking {
namespace {

constexpr double kTop = 0.94;  // [a]

std::vector<Point3> layer() {
    return testing::rendered_layer(8, 4, 0, 5).spheres;
}

double least_distance(const std::vector<Point3>& spheres) {
    double least = 1e9;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const Point3& p = spheres[i];
            const Point3& q = spheres[j];
            least =
                std::min(least, static_cast<double>(std::hypot(p.x - q.x, p.y - q.y, p.z - q.z)));
        }
    }
    return least;
}

TEST(RandomMoves, MakeNoOverlapLarger) {
    const std::vector<Point3> before = layer();
    const std::vector<Point3> after = moved_at_random(before, kTop, 0.06, 40, 1, 0);
    EXPECT_GE(least_distance(after), std::min(1.0, least_distance(before)) - 1e-5);
}

TEST(RandomMoves, StayBetweenThePlatesAndGoSomewhere) {
    const std::vector<Point3> before = layer();
    const std::vector<Point3> after = moved_at_random(before, kTop, 0.06, 40, 1, 0);
    double squares = 0;
    for (std::size_t i = 0; i < after.size(); ++i) {
        EXPECT_GE(after[i].z, 0);
        EXPECT_LE(after[i].z, static_cast<float>(kTop));
        squares += std::pow(static_cast<double>(after[i].x - before[i].x), 2);
    }
    EXPECT_GT(std::sqrt(squares / static_cast<double>(after.size())), 0.01);
}

TEST(RandomMoves, FollowFromSeedAndStream) {
    const auto x_of = [](std::uint64_t seed, std::uint64_t stream) {
        std::vector<float> x;
        for (const Point3& p : moved_at_random(layer(), kTop, 0.06, 5, seed, stream)) {
            x.push_back(p.x);
        }
        return x;
    };
    EXPECT_EQ(x_of(1, 2), x_of(1, 2));
    EXPECT_NE(x_of(1, 2), x_of(1, 3));
    EXPECT_NE(x_of(1, 2), x_of(2, 2));
}

TEST(RandomMoves, OfNoSpheresAreNone) {
    EXPECT_TRUE(moved_at_random({}, kTop, 0.06, 5, 1, 0).empty());
}

}  // namespace
}  // namespace grainfield::tracking
