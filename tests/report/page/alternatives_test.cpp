#include "report/page/alternatives.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace grainfield::report {
namespace {

using testing::HasSubstr;

Alternatives two_by_three() {
    Alternatives all;
    all.title = "Other <settings>";
    all.picture = Image(20, 10, 5);
    all.axes = {{"Polarity", {"dark", "bright"}, 0}, {"Diameter", {"3", "4", "5"}, 1}};
    for (int i = 0; i < 6; ++i) {
        all.tried.push_back({{{0.26 * i, 1.0}}, 3.0 + i % 3, "found " + std::to_string(i), "[x]"});
    }
    return all;
}

TEST(Alternatives, HaveASliderAQuantityThatBeginsAtWhatIsInUse) {
    const std::string html = alternatives_html(two_by_three());
    EXPECT_THAT(html, HasSubstr("<h2>Other &lt;settings&gt;</h2>"));
    EXPECT_THAT(html, HasSubstr("Polarity <input type=\"range\" min=\"0\" max=\"1\" value=\"0\""));
    EXPECT_THAT(html, HasSubstr("Diameter <input type=\"range\" min=\"0\" max=\"2\" value=\"1\""));
}

TEST(Alternatives, KeepPositionsToATenthOfAPixelInTheOrderOfTheAxes) {
    const auto data = nlohmann::json::parse(alternatives_json(two_by_three()));
    EXPECT_EQ(data["tried"].size(), 6U);
    EXPECT_EQ(data["tried"][5]["at"], nlohmann::json({13, 10}));
    EXPECT_EQ(data["tried"][5]["words"], "found 5");
    EXPECT_EQ(data["size"], nlohmann::json({20, 10}));
    EXPECT_THAT(data["image"].get<std::string>(),
                testing::StartsWith("data:image/png;base64,iVBOR"));
}

TEST(Alternatives, AreNothingWhereNoneWereTried) {
    EXPECT_EQ(alternatives_html({}), "");
    EXPECT_EQ(alternatives_json({}), "null");
}

}  // namespace
}  // namespace grainfield::report
