#include "report/report.h"

#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analysis/observables.h"
#include "core/errors.h"
#include "tests/report/sample_results.h"

namespace grainfield::report {
namespace {

using testing::HasSubstr;

std::string content(const std::filesystem::path& path) {
    std::stringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
}

TEST(WriteReport, OfNoRunsIsAWrongOption) {
    const sample::TemporaryFolder folder("report_none");
    RunPlan plan;
    try {
        write_report({}, {}, folder / "r.html", folder / "figures", plan);
        FAIL() << "no exception";
    } catch (const OptionError& error) {
        EXPECT_THAT(error.what(), HasSubstr("at least one results file"));
        EXPECT_THAT(error.what(), HasSubstr("grainfield analyze"));
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(WriteReport, WritesThePageAndTheFiguresBesideIt) {
    const sample::TemporaryFolder folder("report_one");
    RunPlan plan;
    write_report({sample::results({1, 200, 60, true, "A"})},
                 {.title = "My title", .hints = analysis::figure_hints()}, folder / "r.html",
                 folder / "figures", plan);
    const std::string page = content(folder / "r.html");
    EXPECT_THAT(page, HasSubstr("<h1>My title</h1>"));
    EXPECT_THAT(page, HasSubstr("href=\"./figures/sk.csv\""));
    EXPECT_TRUE(std::filesystem::exists(folder / "figures" / "sk.csv"));
}

TEST(WriteReport, WithoutFiguresMakesOneFile) {
    const sample::TemporaryFolder folder("report_alone");
    RunPlan plan;
    write_report({sample::results({1, 200, 60, true, "A"})},
                 {.title = "", .figures = false, .hints = analysis::figure_hints()},
                 folder / "r.html", folder / "figures", plan);
    std::size_t files = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) {
        ++files;
    }
    EXPECT_EQ(files, 1U);
}

TEST(WriteReport, OfTwentyRunsStaysBelow15Megabytes) {
    const sample::TemporaryFolder folder("report_twenty");
    std::vector<Results> runs;
    for (std::uint64_t i = 1; i <= 20; ++i) {
        runs.push_back(sample::results({i, 1012, 260, true, "run " + std::to_string(i)}));
        // Three previews a run, as of a long video.
        runs.back().previews.resize(3, runs.back().previews.front());
    }
    RunPlan plan;
    write_report(runs, {.title = "", .figures = false, .hints = analysis::figure_hints()},
                 folder / "r.html", folder / "figures", plan);
    EXPECT_LE(std::filesystem::file_size(folder / "r.html"), 15'000'000U);
}

TEST(WriteReport, WhereItCannotWriteIsAnOutputError) {
    const sample::TemporaryFolder folder("report_unwritable");
    RunPlan plan;
    EXPECT_THROW(write_report({Results{}}, {.title = "", .figures = false},
                              folder / "absent" / "r.html", folder / "figures", plan),
                 OutputError);
}

}  // namespace
}  // namespace grainfield::report
