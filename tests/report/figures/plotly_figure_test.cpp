#include "report/figures/plotly_figure.h"

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace grainfield::report {
namespace {

using nlohmann::json;

Figure figure_with_hostile_names() {
    Figure figure;
    figure.name = "sk";
    figure.x = {"k", "Wavevector k", "1/a", Scale::log, true};
    figure.y = {"s", "<img src=x onerror=alert(1)>", "", Scale::log, true};
    figure.runs = {"</script><script>alert(1)</script>", "\"quoted\" & 'so' \u2028"};
    figure.kinds = {{"S(k)", Mark::line, true}, {"raw", Mark::line, false}};
    figure.series = {{0, 0, {1, 2}, {3, 4.00000049}, {0.1, std::nan("")}}, {1, 1, {1}, {5}, {}}};
    return figure;
}

TEST(PlotlyFigure, IsInertInAScriptBlock) {
    const std::string text = plotly_json(figure_with_hostile_names());
    EXPECT_EQ(text.find_first_of("<>&"), std::string::npos);
    EXPECT_EQ(text.find("\u2028"), std::string::npos);
}

TEST(PlotlyFigure, GivesNamesBackToTheLegendAndEscapedOnesToPlotly) {
    const Figure figure = figure_with_hostile_names();
    const json page = json::parse(plotly_json(figure));
    EXPECT_EQ(page["runs"][0]["label"], figure.runs[0]);
    EXPECT_EQ(page["runs"][1]["label"], figure.runs[1]);
    // Plotly reads a small subset of HTML in names and titles.
    EXPECT_EQ(page["traces"][0]["name"], "&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;");
    EXPECT_EQ(page["layout"]["yaxis"]["title"]["text"], "&lt;img src=x onerror=alert(1)&gt;");
}

TEST(PlotlyFigure, TurnsNanIntoNullAndKeepsSixDigits) {
    const json page = json::parse(plotly_json(figure_with_hostile_names()));
    EXPECT_TRUE(page["traces"][0]["error_y"]["array"][1].is_null());
    EXPECT_EQ(page["traces"][0]["y"], json::parse("[3.0, 4.0]"));
}

TEST(PlotlyFigure, OpensTheSymbolsOfPointsWithoutError) {
    Figure figure;
    figure.runs = {"A"};
    figure.kinds = {{"S(k)", Mark::line}};
    figure.series = {{0, 0, {1, 2}, {3, 4}, {std::nan(""), 1}}};
    const json whole = json::parse(plotly_json(figure));
    EXPECT_EQ(whole["traces"][0]["marker"]["symbol"], json({"circle-open", "circle"}));
}

TEST(PlotlyFigure, HidesWhatIsShownOnlyOnRequest) {
    const json page = json::parse(plotly_json(figure_with_hostile_names()));
    EXPECT_EQ(page["traces"][0]["visible"], true);
    EXPECT_EQ(page["traces"][1]["visible"], false);
    EXPECT_EQ(page["traces"][1]["meta"], json::parse(R"({"run": 1, "kind": 1})"));
    EXPECT_EQ(page["layout"]["xaxis"]["type"], "log");
}

TEST(PlotlyFigure, DrawsHistogramsOverWholeBins) {
    Figure figure;
    figure.runs = {"A"};
    figure.kinds = {{"density", Mark::steps, true}};
    figure.series = {{0, 0, {0.25, 0.75}, {1.5, 0.5}, {}}};
    const json trace = json::parse(plotly_json(figure))["traces"][0];
    EXPECT_EQ(trace["x"], json::parse("[0.0, 0.0, 0.5, 1.0]"));
    EXPECT_EQ(trace["y"], json::parse("[0.0, 1.5, 0.5, 0.0]"));
    EXPECT_EQ(trace["line"]["shape"], "hv");
}

TEST(PlotlyFigure, FillsTheGuidesThatAreToBeFilledAndNoOthersThatClose) {
    Figure figure;
    figure.kinds = {{"loop", Mark::guide, true}, {"band", Mark::guide, true, "", true}};
    figure.series = {{0, 0, {1, 2, 2, 1}, {1, 1, 2, 1}, {}},
                     {0, 1, {1, 2, 2, 1}, {1, 1, 2, 1}, {}}};
    const json page = json::parse(plotly_json(figure));
    EXPECT_FALSE(page["traces"][0].contains("fill"));
    EXPECT_EQ(page["traces"][1]["fill"], "toself");
}

}  // namespace
}  // namespace grainfield::report
