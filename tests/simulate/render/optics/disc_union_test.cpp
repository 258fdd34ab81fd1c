#include "simulate/render/optics/disc_union.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::simulate {
namespace {

// Exact chords of the union on many lines: good to (1/lines)^1.5.
double chord_union(const std::vector<Disc>& discs, int x, int y) {
    constexpr int lines = 4000;
    double area = 0;
    std::vector<std::pair<double, double>> chords;
    for (int j = 0; j < lines; ++j) {
        const double t = y - 0.5 + (j + 0.5) / lines;
        chords.clear();
        for (const Disc& d : discs) {
            const double square = d.radius * d.radius - (t - d.centre.y) * (t - d.centre.y);
            if (square <= 0) continue;
            const double low = std::max(x - 0.5, d.centre.x - std::sqrt(square));
            const double high = std::min(x + 0.5, d.centre.x + std::sqrt(square));
            if (low < high) chords.emplace_back(low, high);
        }
        std::sort(chords.begin(), chords.end());
        double reached = x - 0.5;
        for (const auto& [low, high] : chords) {
            area += std::max(0.0, high - std::max(low, reached)) / lines;
            reached = std::max(reached, high);
        }
    }
    return area;
}

std::vector<Disc> near_pixel(RandomStream& random, int count, double radius) {
    std::vector<Disc> discs;
    for (int i = 0; i < count; ++i) {
        const double angle = random.uniform(0, 2 * std::numbers::pi);
        const double distance = radius + random.uniform(-0.6, 0.6);
        discs.push_back({{5 + distance * std::cos(angle), 7 + distance * std::sin(angle)}, radius});
    }
    return discs;
}

// What docs/render/optics.md says of pixels where circles cross.
TEST(UnionArea, IsOffByLessThan2e4From4PixelsAndBy1e3At1And1HalfPixels) {
    RandomStream random(5, "union error");
    for (const auto& [radius, limit] :
         {std::pair{1.5, 1e-3}, std::pair{2.5, 5e-4}, std::pair{4.0, 2e-4}, std::pair{8.0, 2e-4},
          std::pair{40.0, 2e-4}}) {
        double worst = 0;
        for (int trial = 0; trial < 1500; ++trial) {
            const std::vector<Disc> discs = near_pixel(random, 2 + trial % 3, radius);
            const double area = union_area(discs.data(), static_cast<int>(discs.size()), 5, 7);
            worst = std::max(worst, std::abs(area - chord_union(discs, 5, 7)));
        }
        RecordProperty("worst_at_" + std::to_string(radius), std::to_string(worst));
        EXPECT_LT(worst, limit) << radius;
    }
}

TEST(UnionArea, OfDiscsThatCoverThePixelOrMissItIsOneOrNothing) {
    const std::vector<Disc> discs{{{5, 7}, 3}, {{15, 7}, 3}, {{5, 7}, 3}};
    EXPECT_NEAR(union_area(discs.data(), 3, 5, 7), 1, 1e-15);
    EXPECT_EQ(union_area(&discs[1], 1, 5, 7), 0);
    EXPECT_EQ(union_area(discs.data(), 0, 5, 7), 0);
}

/// Of `trials` pairs those that union_of_two answers, and its worst error against the chords.
struct Answered {
    int crossing = 0, others = 0;
    double worst = 0;
};
Answered answered(double radius, double other_radius, int trials) {
    RandomStream random(4, "union of two");
    Answered result;
    for (int trial = 0; trial < trials; ++trial) {
        const std::vector<Disc> disc{near_pixel(random, 1, radius)[0],
                                     near_pixel(random, 1, other_radius)[0]};
        const double first = chord_union({disc[0]}, 5, 7);
        const double second = chord_union({disc[1]}, 5, 7);
        const auto joined = union_of_two(disc[0], first, disc[1], second, 5, 7);
        if (!joined) continue;
        const bool is_sum = *joined == first + second;
        const bool is_other = *joined == 1 || *joined == std::max(first, second);
        ++(is_sum || is_other ? result.others : result.crossing);
        result.worst = std::max(result.worst, std::abs(*joined - chord_union(disc, 5, 7)));
    }
    return result;
}

TEST(UnionOfTwo, IsThatOfTheChordsWhereverItAnswers) {
    constexpr int trials = 3000;
    for (const auto& [radius, other] :
         {std::pair{8.0, 8.0}, std::pair{2.0, 2.0}, std::pair{100.0, 100.0}, std::pair{8.0, 8.4},
          std::pair{2.0, 30.0}}) {
        const Answered found = answered(radius, other, trials);
        // 4,000 chords are good to √(2R) (1/4000)^1.5/2 where a circle touches a line.
        EXPECT_LT(found.worst, 2e-6 * std::sqrt(2 * std::max(radius, other)) + 2e-6)
            << radius << ' ' << other;
        EXPECT_GT(found.crossing, trials / 6) << radius << ' ' << other;
        EXPECT_GT(found.crossing + found.others, 0.8 * trials) << radius << ' ' << other;
        RecordProperty("worst_" + std::to_string(radius), std::to_string(found.worst));
    }
    const Answered small = answered(1.5, 1.5, trials);
    EXPECT_LT(small.worst, 1e-5);
    EXPECT_EQ(small.crossing, 0) << "arcs of small circles are not short";
    EXPECT_GT(small.others, trials / 4);
}

TEST(UnionOfTwo, SaysNothingOfTheSameDiscTwice) {
    const Disc disc{{12.8, 7.2}, 8};
    EXPECT_FALSE(union_of_two(disc, 0.5, disc, 0.5, 5, 7));
}

}  // namespace
}  // namespace grainfield::simulate
