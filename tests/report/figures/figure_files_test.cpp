#include "report/figures/figure_files.h"

#include <cmath>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analysis/observables.h"
#include "core/errors.h"
#include "report/figures/figures.h"
#include "tests/report/sample_results.h"

namespace grainfield::report {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

struct Input {
    std::vector<Results> runs{sample::results({1, 150, 40, false, "A"})};
    std::vector<std::string> labels = run_labels(runs);
    std::vector<Figure> figures = make_figures(runs, labels, analysis::figure_hints());
    std::vector<ParticleMap> maps = make_maps(runs, {});
};

TEST(FigureCsv, IsInLongFormWithoutGuides) {
    Figure figure;
    figure.x.name = "k";
    figure.y.name = "s";
    figure.runs = {"A, or \"B\""};
    figure.kinds = {{"S(k)", Mark::line, true}};
    figure.series = {{0, 0, {1, 2}, {3, 4}, {0.5, std::nan("")}}};
    add_power_law(figure, "slope", 1, 1, 1, 10);
    EXPECT_EQ(figure_csv(figure),
              "run,series,k,s,s_err\n"
              "\"A, or \"\"B\"\"\",S(k),1,3,0.5\n"
              "\"A, or \"\"B\"\"\",S(k),2,4,\n");
}

TEST(FigureFiles, AreWrittenForEveryFigureWithData) {
    const sample::TemporaryFolder folder("figure_files");
    const Input input;
    RunPlan plan;
    const auto written = write_figure_files(input.figures, input.maps, input.labels,
                                            folder / "figures", Gnuplot(), plan);
    for (const char* name : {"sk.csv", "variance.csv", "q4_histogram.csv", "map_run1_frame0.svg",
                             "map_run1_frame0.csv"}) {
        EXPECT_THAT(written, Contains(name));
    }
    EXPECT_THAT(written, Not(Contains("msd.csv"))) << "one frame: no displacement";
    const bool has_gnuplot = plan.skipped().empty();
    EXPECT_EQ(std::ranges::count(written, "sk.svg"), has_gnuplot ? 1 : 0);
    std::size_t on_disk = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "figures")) {
        EXPECT_THAT(written, Contains(entry.path().filename().string())) << "no leftovers";
        EXPECT_GT(entry.file_size(), 20U);
        ++on_disk;
    }
    EXPECT_EQ(on_disk, written.size());
}

TEST(FigureFiles, WithoutGnuplotLeaveOutTheSvgOfPlotsAndSaySo) {
    const sample::TemporaryFolder folder("without_gnuplot");
    const Input input;
    RunPlan plan;
    const auto written = write_figure_files(input.figures, input.maps, input.labels, folder.path(),
                                            Gnuplot("grainfield-no-such-program"), plan);
    EXPECT_THAT(written, Contains("sk.csv"));
    EXPECT_THAT(written, Contains("map_run1_frame0.svg"));
    EXPECT_THAT(written, Not(Contains("sk.svg")));
    ASSERT_EQ(plan.skipped().size(), 1U);
    EXPECT_THAT(plan.skipped()[0].reason, HasSubstr("gnuplot"));
}

TEST(FigureFiles, OfAFailingGnuplotDoNotStay) {
    const sample::TemporaryFolder folder("failing_gnuplot");
    const Input input;
    RunPlan plan;
    const auto written =
        write_figure_files(input.figures, {}, input.labels, folder.path(), Gnuplot("false"), plan);
    EXPECT_THAT(written, Not(Contains("sk.svg")));
    ASSERT_EQ(plan.skipped().size(), 1U);
    EXPECT_THAT(plan.skipped()[0].reason, HasSubstr("gnuplot failed"));
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
        EXPECT_NE(entry.path().extension(), ".svg");
        EXPECT_NE(entry.path().extension(), ".part");
    }
}

TEST(FigureFiles, InAPlaceThatIsAFileAreAnOutputError) {
    const sample::TemporaryFolder folder("figures_is_a_file");
    std::ofstream(folder / "figures") << "text";
    RunPlan plan;
    EXPECT_THROW(write_figure_files({}, {}, {}, folder / "figures", Gnuplot(), plan), OutputError);
}

TEST(FigureFiles, OfAnEarlierReportAreRemovedAndNothingElse) {
    const sample::TemporaryFolder folder("earlier_figures");
    const fs::path place = folder / "figures";
    Input input;
    RunPlan plan;
    write_figure_files(input.figures, input.maps, input.labels, place, Gnuplot(), plan);
    ASSERT_TRUE(fs::exists(place / "map_run1_frame0.csv"));
    std::ofstream(place / "my_own.csv") << "keep me";
    std::ofstream(folder / "outside.csv") << "keep me";
    std::ofstream(place / "files.txt", std::ios::app) << "../outside.csv\n";
    write_figure_files(input.figures, {}, input.labels, place, Gnuplot(), plan);
    EXPECT_FALSE(fs::exists(place / "map_run1_frame0.csv"));
    EXPECT_FALSE(fs::exists(place / "map_run1_frame0.svg"));
    EXPECT_TRUE(fs::exists(place / "sk.csv"));
    EXPECT_TRUE(fs::exists(place / "my_own.csv"));
    EXPECT_TRUE(fs::exists(folder / "outside.csv"));
}

}  // namespace
}  // namespace grainfield::report
