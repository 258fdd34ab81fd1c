#include "pipelines/page/report_page.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::pipelines {
namespace {

namespace fs = std::filesystem;

TEST(FiguresFolder, StandsBesideThePage) {
    EXPECT_EQ(figures_folder("a/b.html"), fs::path("a/b_files"));
}

TEST(FiguresFolder, IsRemovedUnlessItIsKeptOrWasThere) {
    const testing::ScratchFolder folder;
    const fs::path path = folder / "p_files";
    {
        const FiguresFolder figures(path, Overwrite::refuse);
        fs::create_directory(path);
    }
    EXPECT_FALSE(fs::exists(path));
    {
        FiguresFolder figures(path, Overwrite::refuse);
        fs::create_directory(path);
        figures.keep();
    }
    EXPECT_TRUE(fs::exists(path));
    EXPECT_THROW(FiguresFolder(path, Overwrite::refuse), OutputError);
    { const FiguresFolder figures(path, Overwrite::force); }
    EXPECT_TRUE(fs::exists(path)) << "it was there before";
}

TEST(ReportPage, LeavesNothingUntilItIsComplete) {
    const testing::ScratchFolder folder;
    Job job;
    report::ReportOptions options;
    options.figures = true;
    Results run;
    run.label = "run";
    run.box = {{0, 0}, {10, 10}, {}, 0};
    {
        ReportPage page(folder / "p.html", options, job);
        page.draw({run}, job, "title");
    }
    EXPECT_EQ(folder.entries(), 0U);
    ReportPage page(folder / "p.html", options, job);
    page.draw({run}, job, "title");
    page.commit(job);
    EXPECT_TRUE(fs::exists(folder / "p.html"));
    ASSERT_EQ(job.outputs.size(), 2U);
    EXPECT_EQ(job.outputs[1], page.figures());
    EXPECT_THROW(ReportPage(folder / "p.html", options, job), OutputError);
}

}  // namespace
}  // namespace grainfield::pipelines
