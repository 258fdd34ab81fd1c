#include "report/page/run_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield::report {
namespace {

using testing::HasSubstr;
using testing::Not;

std::vector<Results> two_runs() {
    std::vector<Results> runs(2);
    for (Results& run : runs) {
        run.record.version = "0.1.0";
        run.record.command = "analyze";
        run.record.inputs = {{"layer.h5", 1234567, "crc32:9ae0daaf"}};
        run.record.configuration = {{"q4.rule", "near-four"}};
        run.record.skipped = {"background fit: uniform"};
    }
    runs[1].record.warnings = {{.text = "frame 7 is corrupt"}};
    return runs;
}

TEST(Remarks, ThatAllRunsShareAreSaidOnce) {
    RunPlan plan;
    plan.skip("SVG of the plots", "no gnuplot", "");
    const std::string html =
        warnings_html(two_runs(), {"A", "B"}, plan) + skipped_html(two_runs(), {"A", "B"}, plan);
    EXPECT_EQ(html.find("background fit"), html.rfind("background fit"));
    EXPECT_THAT(html, HasSubstr("background fit: uniform <span class=\"who\">all runs</span>"));
    EXPECT_THAT(html, HasSubstr("frame 7 is corrupt <span class=\"who\">B</span>"));
    EXPECT_THAT(html, HasSubstr("<li>SVG of the plots: no gnuplot</li>"));
}

TEST(Remarks, AreEmptyWhenThereIsNothingToSay) {
    EXPECT_EQ(warnings_html({Results{}}, {"A"}, {}), "");
    EXPECT_EQ(skipped_html({Results{}}, {"A"}, {}), "");
}

TEST(Warnings, OfManyRunsTakeOneLineAKindAndTheRestIsFolded) {
    std::vector<Results> runs(6);
    std::vector<std::string> labels;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        labels.push_back("run " + std::to_string(r));
        runs[r].record.warnings = {
            {.text = "'film " + std::to_string(r) + "' moves 6.2" + std::to_string(r) + " px"}};
    }
    runs[2].record.warnings.push_back({.text = "the contrast varies"});
    const std::string html = warnings_html(runs, labels, {});
    EXPECT_THAT(html, HasSubstr("<summary>&#39;film 0&#39; moves 6.20 px <span class=\"who\">all "
                                "runs</span></summary>"));
    EXPECT_THAT(html, HasSubstr("<li>run 5: &#39;film 5&#39; moves 6.25 px</li>"));
    EXPECT_THAT(html, HasSubstr("<li>the contrast varies <span class=\"who\">run 2</span></li>"));
    runs.resize(4);
    labels.resize(4);
    EXPECT_THAT(warnings_html(runs, labels, {}), Not(HasSubstr("<summary>"))) << "each by itself";
}

TEST(Records, ShowInputsAndConfiguration) {
    const std::string html = records_html(two_runs(), {"A", "B"});
    EXPECT_THAT(html, HasSubstr("1,234,567 B"));
    EXPECT_THAT(html, HasSubstr("crc32:9ae0daaf"));
    EXPECT_THAT(html, HasSubstr("<details><summary>Configuration (1 options)"));
    EXPECT_THAT(html, HasSubstr("near-four"));
}

TEST(Records, GoBackToTheVideoAndTheOptionsOfTheTracker) {
    auto runs = two_runs();
    RunRecord track;
    track.command = "track";
    track.version = "0.1.0";
    track.inputs = {{"layer.avi", 99, "crc32:00000001"}};
    track.configuration = {{"track.diameter", "8.9"}};
    runs[0].sources = {track};
    const std::string html = records_html(runs, {"A", "B"});
    EXPECT_THAT(html, HasSubstr("layer.avi"));
    EXPECT_THAT(html, HasSubstr("track.diameter"));
    EXPECT_LT(html.find("layer.avi"), html.find("layer.h5"));
}

TEST(Records, FoldALongListOfImages) {
    std::vector<Results> runs(1);
    for (int i = 0; i < 500; ++i) runs[0].record.inputs.push_back({std::to_string(i), 1, ""});
    EXPECT_THAT(records_html(runs, {"A"}), HasSubstr("<summary>Inputs (500 files)</summary>"));
}

TEST(Records, EscapeEverything) {
    const std::string hostile = "\"'><script>alert(1)</script>";
    std::vector<Results> runs(1);
    runs[0].record = {hostile,
                      hostile,
                      0,
                      1,
                      0,
                      {{hostile, hostile}},
                      {{hostile, 1, hostile}},
                      {hostile},
                      {{.text = hostile}}};
    RunPlan plan;
    plan.warn(hostile);
    runs[0].sources = {runs[0].record};
    const std::string html = records_html(runs, {hostile}) + warnings_html(runs, {hostile}, plan) +
                             skipped_html(runs, {hostile}, plan);
    EXPECT_THAT(html, Not(HasSubstr("<script")));
    EXPECT_THAT(html, Not(HasSubstr("\"'>")));
}

}  // namespace
}  // namespace grainfield::report
