#include "report/figures/figure.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace grainfield::report {
namespace {

Figure two_kinds(std::vector<std::string> runs) {
    Figure figure;
    figure.x = {"x", "Time t", "s", Scale::log, false};
    figure.y = {"y", "Count", "", Scale::log, false};
    figure.runs = std::move(runs);
    figure.kinds = {{"solid", Mark::line, true}, {"liquid", Mark::line, true}};
    figure.series = {{0, 0, {1, 2}, {3, -4}, {}}, {0, 1, {5}, {6}, {}}};
    return figure;
}

TEST(Figure, AxisTitleNamesTheUnit) {
    const Figure figure = two_kinds({"A"});
    EXPECT_EQ(figure.x.title(), "Time t [s]");
    EXPECT_EQ(figure.y.title(), "Count");
}

TEST(Figure, OfOneRunIsLabelledAndColouredByKind) {
    const Figure figure = two_kinds({"A"});
    EXPECT_EQ(series_label(figure, figure.series[1]), "liquid");
    EXPECT_NE(style_of(figure, 0, 0).colour, style_of(figure, 0, 1).colour);
}

TEST(Figure, OfSeveralRunsIsColouredAndMarkedByRunAndDashedByKind) {
    Figure figure = two_kinds({"A", "B"});
    EXPECT_EQ(series_label(figure, figure.series[1]), "A, liquid");
    EXPECT_EQ(style_of(figure, 0, 0).colour, style_of(figure, 0, 1).colour);
    EXPECT_NE(style_of(figure, 0, 0).colour, style_of(figure, 1, 0).colour);
    for (const std::size_t run : {0U, 1U}) {
        EXPECT_EQ(style_of(figure, run, 0).symbol, style_of(figure, run, 1).symbol)
            << "that of the legend of runs";
    }
    EXPECT_NE(style_of(figure, 0, 0).dash, style_of(figure, 0, 1).dash) << "in grey";
    EXPECT_EQ(style_of(figure, 0, 1).dash, style_of(figure, 1, 1).dash);
    EXPECT_NE(style_of(figure, 0, 0).symbol, style_of(figure, 1, 0).symbol) << "in grey";
    figure.kinds[1].shown = false;
    EXPECT_EQ(series_label(figure, figure.series[0]), "A") << "the only kind needs no name";
    EXPECT_EQ(series_label(figure, figure.series[1]), "A, liquid");
}

TEST(Figure, GuidesDoNotChangeTheStyleOfData) {
    Figure figure = two_kinds({"A"});
    const Colour before = style_of(figure, 0, 1).colour;
    add_power_law(figure, "slope 1", 1, 1, 1, 10);
    EXPECT_EQ(style_of(figure, 0, 1).colour, before);
    EXPECT_EQ(series_label(figure, figure.series.back()), "slope 1");
}

TEST(Figure, WithOnlyGuidesHasNoData) {
    Figure figure;
    add_power_law(figure, "slope 1", 1, 1, 1, 10);
    EXPECT_FALSE(figure.has_data());
}

TEST(Figure, OpenSymbolsAreForPointsWithoutErrorOfSeriesThatHaveErrors) {
    Figure figure;
    figure.kinds = {{"S", Mark::line}, {"fit", Mark::curve}};
    const double none = std::numeric_limits<double>::quiet_NaN();
    const Series some{0, 0, {1, 2, 3}, {4, 5, 6}, {none, 0.1, 0}};
    EXPECT_EQ(points_without_error(figure, some), (std::vector<std::size_t>{0, 2}));
    const Series never{0, 0, {1, 2}, {4, 5}, {none, none}};
    EXPECT_EQ(points_without_error(figure, never), (std::vector<std::size_t>{0, 1}));
    EXPECT_TRUE(points_without_error(figure, {0, 0, {1, 2}, {4, 5}, {}}).empty());
    Series fit = some;
    fit.kind = 1;
    EXPECT_TRUE(points_without_error(figure, fit).empty());

    figure.series = {{0, 0, {1, 2}, {4, 5}, {}}, fit};
    EXPECT_EQ(open_symbols_sentence(figure), "") << "of a series without errors, and of a fit";
    figure.series.push_back(never);
    EXPECT_EQ(open_symbols_sentence(figure), "Open symbols: the error is not known.");
    figure.series.back() = some;
    EXPECT_EQ(open_symbols_sentence(figure), "Open symbols: the error is not known.");
    figure.y.scale = Scale::log;
    figure.series.back().y = {-4, 5, -6};
    EXPECT_EQ(open_symbols_sentence(figure), "") << "they are not drawn";
    figure.y.scale = Scale::linear;
    figure.kinds[0].shown = false;
    EXPECT_EQ(open_symbols_sentence(figure), "");
}

TEST(Extent, OnALogAxisCountsPositiveValuesOfShownSeries) {
    Figure figure = two_kinds({"A"});
    EXPECT_EQ(extent(figure, figure.y, &Series::y), (std::array{3.0, 6.0}));
    figure.kinds[1].shown = false;
    EXPECT_EQ(extent(figure, figure.y, &Series::y), (std::array{3.0, 3.0}));
    figure.y = {"y", "Count", "", Scale::linear, true};
    EXPECT_EQ(extent(figure, figure.y, &Series::y), (std::array{-4.0, 3.0}));
    figure.series.clear();
    EXPECT_EQ(extent(figure, figure.y, &Series::y), (std::array{0.0, 0.0}));
}

TEST(PowerLaw, HasItsExponentEverywhere) {
    Figure figure;
    add_power_law(figure, "β = 2", 2, 0.5, 3, 50);
    const Series& guide = figure.series.front();
    EXPECT_DOUBLE_EQ(guide.x.front(), 0.5);
    EXPECT_DOUBLE_EQ(guide.y.front(), 3);
    EXPECT_NEAR(guide.x.back(), 50, 1e-12);
    for (std::size_t i = 1; i < guide.x.size(); ++i) {
        const double slope =
            std::log(guide.y[i] / guide.y[i - 1]) / std::log(guide.x[i] / guide.x[i - 1]);
        EXPECT_NEAR(slope, 2, 1e-9);
    }
}

}  // namespace
}  // namespace grainfield::report
