#include "simulate/render/disc_scan.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/frame.h"
#include "core/random.h"

namespace grainfield::simulate {
namespace {

Image painted(const Disc& disc, int width, int height) {
    Image image(width, height);
    DiscScan scan;
    scan.scan(
        disc, width, 0, height,
        [&](int x, int y, double area) { image(x, y) = static_cast<float>(area); },
        [&](int y, int x, int end) {
            for (; x < end; ++x) image(x, y) = 1;
        });
    return image;
}

// Exact chords on many lines: the error of the midpoint rule is below (1/lines)^1.5.
double brute_union(const std::vector<Disc>& discs, int x, int y, int lines) {
    double area = 0;
    for (int j = 0; j < lines; ++j) {
        const double t = y - 0.5 + (j + 0.5) / lines;
        constexpr int points = 2000;
        int inside = 0;
        for (int i = 0; i < points; ++i) {
            const double u = x - 0.5 + (i + 0.5) / points;
            for (const Disc& d : discs) {
                if (std::hypot(u - d.centre.x, t - d.centre.y) < d.radius) {
                    ++inside;
                    break;
                }
            }
        }
        area += static_cast<double>(inside) / points / lines;
    }
    return area;
}

TEST(DiscScan, AreasSumToTheAreaOfTheDisc) {
    RandomStream random(1, "disc scan test");
    for (const double radius : {0.2, 0.5, 1.5, 8.0, 100.0}) {
        for (int i = 0; i < 20; ++i) {
            const Disc disc{{120 + random.uniform(), 120 + random.uniform()}, radius};
            const Image image = painted(disc, 240, 240);
            double sum = 0;
            for (const float a : image.pixels()) sum += static_cast<double>(a);
            // Single precision of the stored areas.
            const double exact = std::numbers::pi * radius * radius;
            EXPECT_NEAR(sum, exact, 1e-6 * exact + 1e-6) << radius;
        }
    }
}

TEST(DiscScan, EveryPixelAgreesWithSupersampling) {
    RandomStream random(2, "disc scan test");
    for (const double radius : {0.3, 1.5, 7.7}) {
        const Disc disc{{9 + random.uniform(), 9 + random.uniform()}, radius};
        const Image image = painted(disc, 20, 20);
        for (int y = 0; y < 20; ++y) {
            for (int x = 0; x < 20; ++x) {
                const bool cut = image(x, y) > 0 && image(x, y) < 1;
                if (!cut && (x + y) % 5 != 0) continue;
                EXPECT_NEAR(image(x, y), brute_union({disc}, x, y, 300), 5e-4) << x << ' ' << y;
            }
        }
    }
}

TEST(DiscScan, ABorderCutsWithoutChangingWhatIsLeft) {
    const Disc disc{{3.3, 60.2}, 7.9};
    const Disc moved{{103.3, 60.2}, 7.9};
    const Image cut = painted(disc, 50, 64);
    const Image whole = painted(moved, 150, 80);
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 50; ++x) EXPECT_NEAR(cut(x, y), whole(x + 100, y), 1e-6F);
    }
}

TEST(DiscScan, DiscsOutsideTouchNothing) {
    for (const Vec2 centre :
         {Vec2{-9, 10}, Vec2{10, -9}, Vec2{40, 10}, Vec2{10, 40}, Vec2{1e9, 0}}) {
        const Image image = painted({centre, 8}, 20, 20);
        for (const float a : image.pixels()) EXPECT_EQ(a, 0);
    }
}

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

// What docs/render.md says of pixels where circles cross.
TEST(UnionArea, IsOffByLessThan2e4From4PixelsAndBy1e3At1And1HalfPixels) {
    RandomStream random(5, "union error");
    for (const auto& [radius, limit] :
         {std::pair{1.5, 1e-3}, std::pair{2.5, 5e-4}, std::pair{4.0, 2e-4}, std::pair{8.0, 2e-4},
          std::pair{40.0, 2e-4}}) {
        double worst = 0;
        for (int trial = 0; trial < 1500; ++trial) {
            std::vector<Disc> discs;
            for (int i = 0; i < 2 + trial % 3; ++i) {
                const double angle = random.uniform(0, 2 * std::numbers::pi);
                const double distance = radius + random.uniform(-0.6, 0.6);
                discs.push_back(
                    {{5 + distance * std::cos(angle), 7 + distance * std::sin(angle)}, radius});
            }
            const double area = union_area(discs.data(), static_cast<int>(discs.size()), 5, 7);
            worst = std::max(worst, std::abs(area - chord_union(discs, 5, 7)));
        }
        RecordProperty("worst_at_" + std::to_string(radius), std::to_string(worst));
        EXPECT_LT(worst, limit) << radius;
    }
}

TEST(UnionArea, AgreesWithSupersamplingForTwoToFourDiscs) {
    RandomStream random(3, "union test");
    for (int trial = 0; trial < 60; ++trial) {
        std::vector<Disc> discs;
        const int count = 2 + trial % 3;
        const double radius = trial % 2 == 0 ? 8 : 1.5;
        for (int i = 0; i < count; ++i) {
            // Circles that pass near the pixel.
            const double angle = random.uniform(0, 2 * std::numbers::pi);
            const double distance = radius + random.uniform(-0.6, 0.6);
            discs.push_back(
                {{5 + distance * std::cos(angle), 7 + distance * std::sin(angle)}, radius});
        }
        EXPECT_NEAR(union_area(discs.data(), count, 5, 7), brute_union(discs, 5, 7, 400), 5e-4);
    }
}

TEST(UnionOfTwo, AgreesWithTheQuadratureWhereverItAnswers) {
    RandomStream random(4, "union of two");
    constexpr int trials = 20000;
    for (const double radius : {8.0, 1.5}) {
        int answered = 0;
        double worst = 0;
        for (int trial = 0; trial < trials; ++trial) {
            Disc disc[2];
            double area[2];
            for (int i = 0; i < 2; ++i) {
                const double angle = random.uniform(0, 2 * std::numbers::pi);
                const double distance = radius + random.uniform(-0.6, 0.6);
                const Vec2 off{distance * std::cos(angle), distance * std::sin(angle)};
                disc[i] = {Vec2{5, 7} + off, radius};
                area[i] = union_area(&disc[i], 1, 5, 7);
            }
            const auto joined = union_of_two(disc[0], area[0], disc[1], area[1], 5, 7);
            if (!joined) continue;
            ++answered;
            worst = std::max(worst, std::abs(*joined - union_area(disc, 2, 5, 7)));
        }
        EXPECT_LT(worst, radius > 2 ? 2e-4 : 1e-3) << radius;  // of the quadrature
        EXPECT_GT(answered, trials / 3);
    }
}

}  // namespace
}  // namespace grainfield::simulate
