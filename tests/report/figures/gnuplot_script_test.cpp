#include "report/figures/gnuplot_script.h"

#include <cmath>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analysis/observables.h"
#include "report/figures/figures.h"
#include "report/figures/gnuplot.h"
#include "tests/report/sample_results.h"

namespace grainfield::report {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string drawn(const Figure& figure, const sample::TemporaryFolder& folder) {
    const auto outcome = Gnuplot().run(gnuplot_script(figure, "x.svg"), folder.path());
    EXPECT_TRUE(outcome.succeeded) << outcome.message;
    EXPECT_EQ(outcome.message, "") << figure.name;
    std::stringstream text;
    text << std::ifstream(folder / "x.svg").rdbuf();
    return text.str();
}

bool has_gnuplot(const sample::TemporaryFolder& folder) {
    return Gnuplot().run("", folder.path()).started;
}

TEST(GnuplotString, HasNoEndInsideAndNoSubstitution) {
    EXPECT_EQ(gnuplot_string("it's"), "'it’s'");
    EXPECT_EQ(gnuplot_string("`rm`\\n\n"), "'’rm’\\n '");
}

TEST(GnuplotScript, EndsErrorBarsAboveZeroOnALogAxis) {
    Figure figure;
    figure.y.scale = Scale::log;
    figure.runs = {"A"};
    figure.kinds = {{"S(k)", Mark::line, true}};
    figure.series = {{0, 0, {1, 2, 3}, {2, -1, 4}, {3, 1, std::nan("")}}};
    const std::string script = gnuplot_script(figure, "x.svg");
    EXPECT_THAT(script, HasSubstr("\n1 2 2e-06 5\n"));
    EXPECT_THAT(script, HasSubstr("\n3 4 4 4\n")) << "no error known";
    EXPECT_THAT(script, Not(HasSubstr("\n2 -1 ")));
}

TEST(GnuplotScript, LeavesTheRimOfPointsWithoutError) {
    Figure figure;
    figure.runs = {"A"};
    figure.kinds = {{"S(k)", Mark::line, true}};
    figure.series = {{0, 0, {1, 2}, {3, 4}, {std::nan(""), 1}}};
    const std::string script = gnuplot_script(figure, "x.svg");
    EXPECT_THAT(script, HasSubstr("$open0 << GRAINFIELD_END\n1 3\nGRAINFIELD_END"));
    EXPECT_THAT(script, HasSubstr("$open0 using 1:2 with points lc rgb '#ffffff'"));
    figure.series[0].error[0] = 1;
    EXPECT_THAT(gnuplot_script(figure, "x.svg"), Not(HasSubstr("$open")));
}

TEST(GnuplotScript, ForPrintNamesRunsOnceAndNoFitsAndHasNoSecondAxis) {
    Figure figure;
    figure.runs = {"A", "B"};
    figure.kinds = {{"S", Mark::line, true}, {"fit", Mark::curve, true}};
    for (std::size_t run : {0U, 1U}) {
        for (std::size_t kind : {0U, 1U}) figure.series.push_back({run, kind, {1, 2}, {3, 4}, {}});
    }
    const std::string script = publication_script(figure, "x.pdf", PlotForm::pdf);
    EXPECT_THAT(script, HasSubstr("title 'A'"));
    EXPECT_THAT(script, HasSubstr("title 'B'"));
    EXPECT_THAT(script, Not(HasSubstr("fit")));
    EXPECT_THAT(script, HasSubstr("size 8.6cm"));
    EXPECT_THAT(script, Not(HasSubstr("set tics"))) << "which turns the axis above on";
    const sample::TemporaryFolder folder("print");
    if (!has_gnuplot(folder))
        GTEST_SKIP() << "no gnuplot here (Debian: apt-get install gnuplot-nox)";
    const auto outcome = Gnuplot().run(script, folder.path());
    EXPECT_TRUE(outcome.succeeded) << outcome.message;
    EXPECT_EQ(outcome.message, "");
}

TEST(GnuplotScript, ForPrintHasLettersOfOneSizeAsPngAndAsSvg) {
    Figure figure;
    figure.runs = {"A"};
    figure.kinds = {{"S", Mark::line, true}};
    figure.series = {{0, 0, {1, 2}, {3, 4}, {}}};
    const auto number = [](const std::string& script, const std::string& before) {
        const auto at = script.find(before);
        return at == std::string::npos ? 0 : std::stod(script.substr(at + before.size()));
    };
    const std::string svg = publication_script(figure, "x", PlotForm::svg);
    const std::string png = publication_script(figure, "x", PlotForm::png);
    const std::string font = "font 'sans-serif,";
    const double zoom = number(png, " size ") / number(svg, " size ");
    EXPECT_NEAR(zoom, 600.0 / 96, 0.01);
    // Pixels in SVG; pngcairo has points, 72 an inch of 96 pixels.
    const double letters = number(png, font) * 96 / 72 * number(png, "fontscale ");
    EXPECT_NEAR(letters, zoom * number(svg, font), 0.02 * letters);
    EXPECT_NEAR(number(png, "linewidth "), zoom, 0.02 * zoom);
}

TEST(GnuplotScript, ForPrintHasAtMostSevenLabelsOnALinearAxis) {
    for (const double last : {0.159, 0.2, 1.0, 5.56, 60.0, 999.0}) {
        Figure figure;
        figure.runs = {"A"};
        figure.kinds = {{"S", Mark::line, true}};
        figure.series = {{0, 0, {0, last}, {0, 1}, {}}};
        const std::string script = publication_script(figure, "x.pdf", PlotForm::pdf);
        const std::string before = "set xtics ";
        const auto at = script.rfind(before);
        ASSERT_NE(at, std::string::npos);
        const double step = std::stod(script.substr(at + before.size()));
        EXPECT_LE(1.08 * last / step, 6) << last;
        EXPECT_GE(1.08 * last / step, 2) << last;
    }
}

TEST(GnuplotScript, NamesRunsAndKindsOnceEach) {
    Figure figure;
    figure.runs = {"A", "B"};
    figure.kinds = {{"solid", Mark::line, true}, {"liquid", Mark::line, true}};
    for (std::size_t run : {0U, 1U}) {
        for (std::size_t kind : {0U, 1U}) figure.series.push_back({run, kind, {1, 2}, {3, 4}, {}});
    }
    const std::string script = gnuplot_script(figure, "x.svg");
    for (const char* title : {"title 'A'", "title 'B'", "title 'solid'", "title 'liquid'"}) {
        const auto first = script.find(title);
        EXPECT_NE(first, std::string::npos) << title;
        EXPECT_EQ(first, script.rfind(title)) << title;
    }
}

TEST(GnuplotScript, DrawsEveryFigureWithoutComplaint) {
    const sample::TemporaryFolder folder("gnuplot_script");
    if (!has_gnuplot(folder)) GTEST_SKIP() << "gnuplot is not installed";
    const std::vector<Results> runs{sample::results({1, 200, 60, true, "A"}),
                                    sample::results({2, 200, 60, true, "B"})};
    for (const Figure& figure : make_figures(runs, run_labels(runs), analysis::figure_hints())) {
        const std::string svg = drawn(figure, folder);
        EXPECT_THAT(svg, HasSubstr("</svg>"));
        EXPECT_THAT(svg, HasSubstr(figure.x.label)) << "the axis has its title";
    }
}

TEST(GnuplotScript, TreatsHostileNamesAsText) {
    const sample::TemporaryFolder folder("gnuplot_hostile");
    if (!has_gnuplot(folder)) GTEST_SKIP() << "gnuplot is not installed";
    std::vector<Results> runs{
        sample::results({1, 200, 60, true, "'; system 'touch pwned'; a='"}),
        sample::results({2, 200, 60, true, "`touch pwned` $(touch pwned) </text><script>_{x}"})};
    const auto figures = make_figures(runs, run_labels(runs), analysis::figure_hints());
    const std::string svg = drawn(figures[1], folder);
    EXPECT_FALSE(std::filesystem::exists(folder / "pwned"));
    EXPECT_THAT(svg, HasSubstr("; system"));
    EXPECT_THAT(svg, HasSubstr("&lt;/text>&lt;script>_{x}")) << "no markup";
    EXPECT_THAT(svg, Not(HasSubstr("<script>")));
}

TEST(GnuplotScript, DrawsOnePointAndValuesWithoutSpread) {
    const sample::TemporaryFolder folder("gnuplot_single");
    if (!has_gnuplot(folder)) GTEST_SKIP() << "gnuplot is not installed";
    for (Scale scale : {Scale::linear, Scale::log}) {
        Figure figure;
        figure.x.scale = figure.y.scale = scale;
        figure.runs = {"A"};
        figure.kinds = {{"all", Mark::line, true}};
        figure.series = {{0, 0, {1}, {2}, {}}};
        EXPECT_THAT(drawn(figure, folder), HasSubstr("</svg>"));
    }
}

}  // namespace
}  // namespace grainfield::report
