#include "report/maps/map_svg.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield::report {
namespace {

using testing::HasSubstr;
using testing::Not;

ParticleMap two_discs() {
    ParticleMap map;
    map.title = "frame 3, 2 particles";
    map.x = {0, 90};
    map.y = {0, 45};
    map.diameter = 10;
    map.position = {{9, 9}, {81, 9}};
    map.abs_q4 = {1, std::nan("")};
    return map;
}

TEST(MapSvg, PutsDiscsAt85PercentOfTheDiameterWhereTheyAre) {
    const std::string svg = map_svg(two_discs(), "A");  // 10 units per unit of length
    EXPECT_THAT(svg, HasSubstr("stroke-width=\"85.000\""));
    EXPECT_THAT(svg, HasSubstr("stroke=\"#fde725\" d=\"M90.00 90.00h.01\""));
    EXPECT_THAT(svg, HasSubstr("stroke=\"#999999\" d=\"M810.00 90.00h.01\"")) << "undefined: grey";
}

TEST(MapSvg, TurnsSimulationsUpright) {
    ParticleMap map = two_discs();
    map.y_down = false;
    EXPECT_THAT(map_svg(map, "A"), HasSubstr("M90.00 360.00h.01"));
}

TEST(MapSvg, EscapesNames) {
    const std::string svg = map_svg(two_discs(), "</text><script>alert(1)</script>");
    EXPECT_THAT(svg, Not(HasSubstr("<script>")));
    EXPECT_THAT(svg, HasSubstr("&lt;/text&gt;&lt;script&gt;"));
}

TEST(MapSvg, WithoutOrderHasNoColourBar) {
    ParticleMap map = two_discs();
    EXPECT_THAT(map_svg(map, "A"), HasSubstr("url(#order)"));
    map.abs_q4.clear();
    EXPECT_THAT(map_svg(map, "A"), Not(HasSubstr("url(#order)")));
}

}  // namespace
}  // namespace grainfield::report
