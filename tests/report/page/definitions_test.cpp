#include "report/page/definitions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield::report {
namespace {

using testing::HasSubstr;

std::size_t terms(const std::string& html) {
    std::size_t count = 0;
    for (auto at = html.find("class=\"term\""); at != std::string::npos;
         at = html.find("class=\"term\"", at + 1)) {
        ++count;
    }
    return count;
}

TEST(Definitions, ExplainEachSymbolOnceAndOnTheKeyboard) {
    const std::string html = with_definitions("Mean |Q₄| and |Q₄|, S₀/S₁ <b>");
    EXPECT_EQ(terms(html), 2U);
    EXPECT_THAT(html, HasSubstr("tabindex=\"0\""));
    EXPECT_THAT(html, HasSubstr("&lt;b&gt;"));
}

TEST(Definitions, LeaveWordsAloneThatOnlyContainATerm) {
    EXPECT_EQ(terms(with_definitions("RMSDs and residuals")), 0U);
    EXPECT_EQ(terms(with_definitions("the residual")), 1U);
}

TEST(Definitions, KnowTheSymbolsOfTheField) {
    for (const char* term : {"Γ", "ε", "|Q₄|", "S₁", "S₀", "MSD", "S(k)"}) {
        EXPECT_FALSE(definition_of(term).empty()) << term;
    }
    EXPECT_TRUE(definition_of("something").empty());
}

}  // namespace
}  // namespace grainfield::report
