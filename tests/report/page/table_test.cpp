#include "report/page/table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield::report {
namespace {

using testing::HasSubstr;
using testing::Not;

Table sample_table() {
    Table table;
    table.name = "scores";
    table.title = "Scores <by class>";
    table.columns = {
        {"recall", "Recall", ""}, {"rmse", "RMSE", "px"}, {"state", "State", "", true}};
    table.rows = {{"liquid, dense", {{0.99871, "", false}, {0.0083, "", true}, {1, "met", false}}},
                  {"crystal", {{}, {}, {std::nan(""), "no \"bound\"", false}}}};
    return table;
}

TEST(Table, AsHtmlEscapesTextsAndMarksWhatFailed) {
    const std::string html = table_html(sample_table());
    EXPECT_THAT(html, HasSubstr("Scores &lt;by class&gt;"));
    EXPECT_THAT(html, HasSubstr("<td class=\"failed\">0.0083</td>"));
    EXPECT_THAT(html, HasSubstr("RMSE <span class=\"unit\">[px]</span>"));
    EXPECT_THAT(html, HasSubstr("<td>–</td>"));
    EXPECT_THAT(html, HasSubstr("<td class=\"words\">met</td>"));
    EXPECT_THAT(html, HasSubstr("no &quot;bound&quot;"));
    EXPECT_THAT(html, Not(HasSubstr("nan")));
}

TEST(Table, AsCsvKeepsNumbersWhereTheyAre) {
    EXPECT_EQ(table_csv(sample_table()),
              "name,recall,rmse,state\n"
              "\"liquid, dense\",0.99871,0.0083,1\n"
              "crystal,,,\"no \"\"bound\"\"\"\n");
}

}  // namespace
}  // namespace grainfield::report
