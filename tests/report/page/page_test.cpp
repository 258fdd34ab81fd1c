#include "report/page/page.h"

#include <cmath>
#include <fstream>
#include <regex>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "analysis/observables.h"
#include "report/figures/figures.h"
#include "report/page/embedded.h"
#include "tests/report/sample_results.h"

namespace grainfield::report {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string page_of(const std::vector<Results>& runs, const std::string& title = "Title",
                    std::vector<std::string> files = {}) {
    const auto labels = run_labels(runs);
    const auto figures = make_figures(runs, labels, analysis::figure_hints());
    const auto maps = make_maps(runs, {});
    return page_html({title, runs, labels, figures, maps, "the figures", std::move(files), {}, {}});
}

std::string between(const std::string& text, const std::string& start, const std::string& end) {
    const auto from = text.find(start) + start.size();
    return text.substr(from, text.find(end, from) - from);
}

// The page without the two programs and their licence.
std::string without_scripts(std::string page) {
    for (std::string_view part : {plotly_script, page_script, plotly_licence}) {
        const auto at = page.find(part);
        EXPECT_NE(at, std::string::npos);
        page.erase(at, part.size());
    }
    return page;
}

TEST(Page, IsTheSameForTheSameContent) {
    const std::vector<Results> runs{sample::results({1, 120, 40, true, "A"})};
    EXPECT_EQ(page_of(runs), page_of(runs));
}

TEST(Page, RefersToNothingOutside) {
    const std::string page = without_scripts(page_of({sample::results({1, 120, 40, true, "A"})}));
    const std::regex outside(
        R"((src|href|action|data)\s*=\s*["']?\s*(https?:|//)|url\(\s*["']?(https?:|//)|@import)");
    EXPECT_FALSE(std::regex_search(page, outside));
    EXPECT_THAT(page, HasSubstr("default-src 'none'"));
}

TEST(Page, CarriesTheLicenceOfPlotly) {
    const std::string page = page_of({Results{}});
    EXPECT_THAT(page, HasSubstr("Permission is hereby granted, free of charge"));
    EXPECT_THAT(page, HasSubstr("Licensed under the MIT license"));
}

TEST(Page, EmbedsItsScriptsByteForByte) {
    std::stringstream file;
    file << std::ifstream(std::string(GRAINFIELD_SOURCE_DIR) + "/report/page/page.js").rdbuf();
    EXPECT_EQ(page_script, file.str());
    std::stringstream space;
    space << std::ifstream(std::string(GRAINFIELD_SOURCE_DIR) + "/report/page/space.js").rdbuf();
    EXPECT_EQ(space_script, space.str());
    EXPECT_EQ(space_script.find("</script"), std::string_view::npos);
    EXPECT_EQ(plotly_script.find("</script"), std::string_view::npos);
    EXPECT_EQ(page_script.find("</script"), std::string_view::npos);
    EXPECT_EQ(plotly_licence.find("--"), std::string_view::npos);
}

TEST(Page, KeepsHostileTextInert) {
    const std::string hostile =
        "</script><script>document.title='pwned'</script>\"'><img src=x onerror=alert(1)>";
    std::vector<Results> runs{sample::results({1, 120, 40, true, hostile}),
                              sample::results({2, 120, 40, true, hostile})};
    runs[0].record.inputs[0].name = hostile;
    runs[0].record.configuration = {{hostile, hostile}};
    runs[0].record.warnings = {{.text = hostile}};
    runs[0].observables[0].measurements[0].reason = hostile;
    runs[0].observables[3].curves[0].title = hostile;
    const std::string page = without_scripts(page_of(runs, hostile, {"sk.svg"}));
    EXPECT_THAT(page, Not(HasSubstr("<script>document")));
    EXPECT_THAT(page, Not(HasSubstr("<img")));
    // Two programs and the data.
    const std::regex start("<script");
    EXPECT_EQ(std::distance(std::sregex_iterator(page.begin(), page.end(), start), {}), 3);
}

TEST(Page, DataSurviveAParser) {
    std::vector<Results> runs{sample::results({1, 120, 40, true, "</script> \" \\ \u2028 Γ"})};
    const std::string page = page_of(runs);
    const auto data = nlohmann::json::parse(
        between(page, "<script type=\"application/json\" id=\"report-data\">", "</script>"));
    EXPECT_EQ(data["figures"].size(), 5U);
    EXPECT_EQ(data["maps"].size(), 1U);
    EXPECT_EQ(data["colours"].size(), 255U);
    EXPECT_EQ(data["figures"][0]["runs"][0]["label"], run_labels(runs)[0]);
}

TEST(Page, PutsThePicturesThatAreNotShownAtFirstBehindTheScripts) {
    std::vector<Results> runs;
    for (std::uint64_t i = 1; i <= 3; ++i) {
        runs.push_back(sample::results({i, 120, 40, true, "run " + std::to_string(i)}));
    }
    const std::string page = page_of(runs);
    const auto data = nlohmann::json::parse(
        between(page, "<script type=\"application/json\" id=\"report-data\">", "</script>"));
    const auto images = nlohmann::json::parse(
        between(page, "<script type=\"application/json\" id=\"report-images\">", "</script>"));
    ASSERT_EQ(data["maps"].size(), 3U);
    EXPECT_THAT(data["maps"][0]["image"].get<std::string>(), HasSubstr("data:image/png"));
    EXPECT_THAT(data["maps"][1]["image"].get<std::string>(), HasSubstr("data:image/png"));
    EXPECT_TRUE(data["maps"][2]["image"].is_null());
    ASSERT_EQ(images.size(), 1U);
    EXPECT_THAT(images["2"].get<std::string>(), HasSubstr("data:image/png"));
    EXPECT_LT(page.find(page_script), page.find("id=\"report-images\""));
    EXPECT_THAT(page_of({runs[0], runs[1]}), Not(HasSubstr("id=\"report-images\"")));
}

TEST(Page, SaysInOneLineWhatOneFrameDoesNotGive) {
    const std::string page = page_of({sample::results({1, 120, 40, false, "A"})});
    EXPECT_THAT(page, HasSubstr("<summary>Not possible with one frame: "));
    EXPECT_THAT(page, HasSubstr("displacement"));
    EXPECT_THAT(page, HasSubstr("one frame: displacements need two")) << "unfolded";
    EXPECT_THAT(page, Not(HasSubstr("figure-msd"))) << "no empty panel";
    EXPECT_THAT(page, Not(HasSubstr("id=\"plot-msd\"")));
    EXPECT_THAT(page, HasSubstr("id=\"plot-sk\""));
}

TEST(Page, LinksOnlyFilesThatExist) {
    const std::string page = page_of({sample::results({1, 120, 40, true, "A"})}, "T", {"sk.csv"});
    EXPECT_THAT(page, HasSubstr("href=\"./the%20figures/sk.csv\""));
    EXPECT_THAT(page, Not(HasSubstr("sk.svg")));
}

TEST(Page, NamesTheMapAfterWhatItShows) {
    EXPECT_THAT(page_of({sample::results()}), HasSubstr("<h2>Frame with detections</h2>"));
    Results without = sample::results();
    for (Preview& preview : without.previews) preview.frame.image = {};
    EXPECT_THAT(page_of({without}), HasSubstr("<h2>Positions</h2>"));
}

TEST(Page, ShowsTheLayerFromTheSideOnlyWhereHeightsAreKnown) {
    Results run = sample::results({1, 120, 40, true, "A"});
    const std::string without = page_of({run});
    EXPECT_THAT(without, Not(HasSubstr("The layer from the side")));
    EXPECT_THAT(without, Not(HasSubstr(std::string(space_script)))) << "nor its script";
    EXPECT_THAT(without, Not(HasSubstr("from the side\"")));
    run.previews[0].snapshot.z.assign(run.previews[0].snapshot.size(), 5.0);
    const std::string with = page_of({run});
    EXPECT_THAT(with, HasSubstr("<h2>The layer from the side</h2>"));
    EXPECT_THAT(with, HasSubstr("<script>" + std::string(space_script) + "</script>"));
    EXPECT_THAT(with, HasSubstr("Enter shows the place from the side"));
    const std::regex views("<canvas class=\"(side|patch)\"");
    EXPECT_EQ(std::distance(std::sregex_iterator(with.begin(), with.end(), views), {}), 2);
    EXPECT_LT(with.find("class=\"cards\""), with.find("<section class=\"space\">"));
    EXPECT_LT(with.find("<section class=\"space\">"), with.find("figure-q4_histogram"));
}

TEST(Page, ShowsBothOfTwoRunsFromTheSideThoughOneAloneHasHeights) {
    std::vector<Results> runs{sample::results({1, 120, 40, true, "A"}),
                              sample::results({2, 120, 40, true, "B"})};
    runs[1].previews[0].snapshot.z.assign(runs[1].previews[0].snapshot.size(), 5.0);
    const std::string page = page_of(runs);
    const std::regex views("<canvas class=\"(side|patch)\"");
    EXPECT_EQ(std::distance(std::sregex_iterator(page.begin(), page.end(), views), {}), 4)
        << "one of each for every picture; the script hides those without";
}

TEST(Page, OfEmptyResultsSaysThatThereIsNothing) {
    const std::string page = page_of({Results{}});
    for (const char* part : {"0 spheres a frame", "No picture", "How this was made"}) {
        EXPECT_THAT(page, HasSubstr(part));
    }
    EXPECT_THAT(page, Not(HasSubstr("class=\"card\"")));
    EXPECT_THAT(page, Not(HasSubstr("<figure")));
}

TEST(Page, BeginsWithVerdictPictureAndCards) {
    const std::string page = page_of({sample::results({1, 120, 40, true, "A"})});
    const auto verdict = page.find("class=\"verdict\"");
    const auto picture = page.find("<figure id=\"map\">");
    const auto cards = page.find("class=\"cards\"");
    const auto order = page.find("figure-q4_histogram");
    const auto moves = page.find("figure-msd");
    const auto waves = page.find("figure-sk\"");
    const auto variance = page.find("figure-variance\"");
    EXPECT_LT(verdict, picture);
    EXPECT_LT(picture, cards);
    EXPECT_LT(cards, order);
    EXPECT_LT(order, moves);
    EXPECT_LT(moves, waves);
    EXPECT_LT(waves, variance);
    EXPECT_LT(variance, page.find("All numbers"));
    EXPECT_THAT(page, HasSubstr("value=\"outlines\" aria-pressed=\"true\""))
        << "opaque discs would hide what they should prove";
}

TEST(Page, PutsTwoRunsSideBySideAndDifferencesBelowTheCurves) {
    const std::vector<Results> runs{sample::results({1, 120, 40, true, "A"}),
                                    sample::results({2, 120, 40, true, "B"})};
    const auto labels = run_labels(runs);
    const auto figures = make_figures(runs, labels, analysis::figure_hints());
    const auto maps = make_maps(runs, {});
    Table differences;
    differences.name = "differences";
    differences.title = "Differences";
    const std::vector<Table> tables{differences};
    const std::string page = page_html({"T", runs, labels, figures, maps, "", {}, {}, tables});
    const std::regex view("class=\"view\"");
    EXPECT_EQ(std::distance(std::sregex_iterator(page.begin(), page.end(), view), {}), 2);
    EXPECT_LT(page.find("figure-variance\""), page.find("<section id=\"table-differences\""));
}

}  // namespace
}  // namespace grainfield::report
