#include "report/maps/map_pdf.h"

#include <cmath>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield::report {
namespace {

using testing::HasSubstr;

ParticleMap two_discs() {
    ParticleMap map;
    map.title = "frame 0";
    map.x = {0, 10};
    map.y = {0, 20};
    map.y_down = false;
    map.diameter = 1;
    map.position = {{5, 5}, {2, 15}};
    map.abs_q4 = {1, std::nan("")};
    return map;
}

TEST(MapPdf, DrawsEachParticleAt85PercentOfItsDiameter) {
    const std::string pdf = map_pdf(two_discs(), "A");
    EXPECT_THAT(pdf, HasSubstr("40.800 w")) << "0.85 of 480/10 points";
    EXPECT_THAT(pdf, HasSubstr("240.00 240.00 m 240.00 240.00 l"));
    EXPECT_THAT(pdf, HasSubstr("96.00 720.00 m"));
    ParticleMap down = two_discs();
    down.y_down = true;
    EXPECT_THAT(map_pdf(down, "A"), HasSubstr("240.00 720.00 m")) << "pixels count downwards";
}

TEST(MapPdf, HasATableThatPointsAtItsObjects) {
    const std::string pdf = map_pdf(two_discs(), "Γ = 4.5 (a) \\");
    EXPECT_TRUE(pdf.starts_with("%PDF-1.4"));
    EXPECT_TRUE(pdf.ends_with("%%EOF\n"));
    const std::size_t start = std::stoul(pdf.substr(pdf.rfind("startxref") + 10));
    EXPECT_EQ(pdf.compare(start, 4, "xref"), 0);
    const std::regex entry("(\\d{10}) 00000 n");
    const std::string table = pdf.substr(start);
    int object = 0;
    for (std::sregex_iterator it(table.begin(), table.end(), entry), end; it != end; ++it) {
        const std::string begin = std::to_string(++object) + " 0 obj";
        EXPECT_EQ(pdf.compare(std::stoul((*it)[1]), begin.size(), begin), 0);
    }
    EXPECT_EQ(object, 6);
    EXPECT_THAT(pdf, HasSubstr("/Title <FEFF0393")) << "Γ in UTF-16";
}

}  // namespace
}  // namespace grainfield::report
