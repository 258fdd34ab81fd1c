#include "report/page/paper_section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield::report {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(PaperSection, PutsRowsOfSystemsAndColumnsOfQuantitiesInTheOrderOfThePaper) {
    std::vector<PaperPanel> panels;
    for (const char* number :
         {"4b", "2i", "2a", "2e", "1b", "3", "2b", "2d", "2c", "2f", "2g", "2h", "4a"}) {
        panels.push_back({.number = number, .title = "t", .claim = "c", .absent = "none"});
    }
    const std::string html = paper_section_html(panels, nullptr, "");
    std::size_t at = 0;
    for (const char* number :
         {"1b", "2a", "2b", "2c", "2d", "2e", "2f", "2g", "2h", "2i", "3", "4a", "4b"}) {
        const std::size_t next = html.find(std::string("data-panel=\"") + number + "\"");
        ASSERT_NE(next, std::string::npos) << number;
        EXPECT_GT(next, at) << number;
        at = next;
    }
    EXPECT_THAT(html, HasSubstr("no tracked run keeps a frame with |Q₄|"));
}

TEST(PaperSection, SaysTheVerdictOfEachNumberAndEscapesWhatUsersWrite) {
    PaperPanel panel{.number = "2b", .title = "S₀/S₁", .claim = "a line", .absent = "<b>"};
    panel.lines = {{"Γc: paper 4.73, ours <i>", Agreement::differs, "differs by 4.2 σ"}};
    const std::string html = paper_section_html({panel}, nullptr, "");
    EXPECT_THAT(html, HasSubstr("<p class=\"line differs\">Γc: paper 4.73, ours &lt;i&gt;. "
                                "<strong>differs by 4.2 σ</strong></p>"));
    EXPECT_THAT(html, HasSubstr("Not drawn: &lt;b&gt;."));
    EXPECT_THAT(html, Not(HasSubstr("The paper gives no number here")));
}

TEST(PaperSection, ShowsTheDiscsOfTheMapWithoutTheFrameBelow) {
    ParticleMap map;
    map.x = map.y = {0, 10};
    map.position = {{4, 5}};
    map.abs_q4 = {0.9};
    map.png = {1, 2, 3};
    const std::string html = paper_section_html({}, &map, "tracked");
    EXPECT_THAT(html, HasSubstr("<svg"));
    EXPECT_THAT(html, Not(HasSubstr("<image")));
}

TEST(PaperSection, TakesAMapOfItsRunThatHasTheOrder) {
    std::vector<ParticleMap> maps(3);
    maps[0].run = 1;
    maps[1].run = 1;
    maps[1].abs_q4 = {0.5};
    maps[2].abs_q4 = {0.5};
    EXPECT_EQ(paper_map(maps, 1), &maps[1]);
    EXPECT_EQ(paper_map(maps, 2), nullptr);
    EXPECT_EQ(paper_map(maps, std::nullopt), nullptr);
}

}  // namespace
}  // namespace grainfield::report
