#include "simulate/render/optics/arc_area.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace grainfield::simulate {
namespace {

TEST(ArcAreas, AreThoseOfTheLibrarysArcSine) {
    for (const double radius : {0.3, 8.0, 1000.0}) {
        std::vector<double> t;
        for (int i = -20000; i <= 20000; ++i) t.push_back(radius * i / 20000);
        std::vector<double> h(t.size());
        std::vector<double> area(t.size());
        arc_areas(t.data(), t.size(), radius, h.data(), area.data());
        double worst = 0;
        for (std::size_t i = 0; i < t.size(); ++i) {
            const double half = std::sqrt(std::max(0.0, radius * radius - t[i] * t[i]));
            const double exact = 0.5 * (t[i] * half + radius * radius * std::asin(t[i] / radius));
            EXPECT_EQ(h[i], half);
            worst = std::max(worst, std::abs(area[i] - exact));
        }
        EXPECT_LT(worst, 1e-15 * radius * radius) << radius;
    }
}

TEST(ArcAreas, BeyondTheCircleAreThoseOfItsHalf) {
    const double t[] = {-8.001, 8.001};
    double h[2];
    double area[2];
    arc_areas(t, 2, 8, h, area);
    EXPECT_EQ(h[0], 0);
    EXPECT_NEAR(area[1], 16 * std::acos(-1.0), 1e-13);
    EXPECT_EQ(area[0], -area[1]);
}

}  // namespace
}  // namespace grainfield::simulate
