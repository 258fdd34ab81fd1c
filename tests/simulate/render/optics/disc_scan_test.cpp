#include "simulate/render/optics/disc_scan.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/frame.h"
#include "core/support/random.h"

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

}  // namespace
}  // namespace grainfield::simulate
