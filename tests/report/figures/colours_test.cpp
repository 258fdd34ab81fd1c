#include "report/figures/colours.h"

#include <cmath>
#include <set>
#include <string>

#include <gtest/gtest.h>

namespace grainfield::report {
namespace {

double lightness(Colour colour) {  // CIE L*
    double y = 0;
    const double weight[3] = {0.2126, 0.7152, 0.0722};
    for (std::size_t c = 0; c < 3; ++c) {
        const double v = colour[c] / 255.0;
        y += weight[c] * (v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
    }
    return y > 0.008856 ? 116 * std::cbrt(y) - 16 : 903.3 * y;
}

// viridis runs from L* = 15 to 91; uniform steps are 7.6 per tenth, anchors are rounded and the
// space it is uniform in is not exactly L*.
TEST(Viridis, GetsLighterInNearlyEqualSteps) {
    for (int i = 0; i < 10; ++i) {
        const double step = lightness(viridis((i + 1) / 10.0)) - lightness(viridis(i / 10.0));
        EXPECT_GT(step, 5) << i;
        EXPECT_LT(step, 10) << i;
    }
}

TEST(Viridis, ClampsAndShowsUnknownInGrey) {
    EXPECT_EQ(viridis(-1), viridis(0));
    EXPECT_EQ(viridis(7), viridis(1));
    EXPECT_EQ(hex(viridis(0)), "#440154");
    EXPECT_EQ(hex(viridis(1)), "#fde725");
    const Colour grey = viridis(std::nan(""));
    EXPECT_EQ(grey[0], grey[1]);
    EXPECT_EQ(grey[1], grey[2]);
}

TEST(DistinctColour, IsDistinctForAnyNumberOfRuns) {
    for (std::size_t count : {1U, 2U, 7U, 8U, 20U, 60U}) {
        std::set<std::string> seen;
        for (std::size_t i = 0; i < count; ++i) seen.insert(hex(distinct_colour(i, count)));
        EXPECT_EQ(seen.size(), count);
    }
}

}  // namespace
}  // namespace grainfield::report
