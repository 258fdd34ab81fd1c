#include "analysis/statistics/run_series.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace grainfield::analysis {
namespace {

Curve series_of(std::vector<double> energy) {
    Curve curve{.name = "md", .title = "", .columns = {}, .text_columns = {}};
    std::vector<double> t, audit;
    for (std::size_t i = 0; i < energy.size(); ++i) {
        t.push_back(static_cast<double>(i));
        audit.push_back(1e-15);
    }
    curve.columns = {{"t", "periods", "time", t},
                     {"energy_xy", "m g a", "energy", std::move(energy)},
                     {"audit", "m g a", "balance", audit}};
    return curve;
}

TEST(RunSeries, AveragesTheLaterHalfOnly) {
    std::vector<double> energy(200, 5.0);
    for (std::size_t i = 100; i < 200; ++i) energy[i] = i % 2 == 0 ? 1 : 3;
    const ObservableResult result = run_series({series_of(energy)});
    EXPECT_TRUE(result.reason.empty());
    ASSERT_EQ(result.measurements.size(), 1U) << "neither time nor audit";
    EXPECT_EQ(result.measurements[0].name, "energy_xy");
    EXPECT_EQ(result.measurements[0].unit, "m g a");
    EXPECT_NEAR(result.measurements[0].value.value(), 2, 1e-12);
    EXPECT_EQ(result.curves.front().find("t")->values.size(), 200U);
}

TEST(RunSeries, ErrorsAreThoseOfIndependentRows) {
    // 400 late rows that follow each other in runs of ten: 40 independent ones.
    std::vector<double> energy;
    for (int i = 0; i < 800; ++i) energy.push_back(std::sin(37.0 * (i / 10) * (i / 10)));
    const Measurement m = run_series({series_of(energy)}).measurements.front();
    EXPECT_GT(m.error.value(), 0.05);  // 0.7/sqrt(40) = 0.11
    EXPECT_LT(m.samples, 120);
}

TEST(RunSeries, GivesNoErrorToAWaveAsLongAsTheRun) {
    std::vector<double> energy;
    for (int i = 0; i < 200; ++i) energy.push_back(std::sin(i * 0.06));  // 105 rows a period
    const Measurement m = run_series({series_of(energy)}).measurements.front();
    EXPECT_TRUE(m.value.has_value());
    EXPECT_FALSE(m.error.has_value());
    EXPECT_NE(m.reason.find("too slowly"), std::string::npos);
}

TEST(RunSeries, SaysWhyThereIsNothing) {
    EXPECT_FALSE(run_series({}).reason.empty());
    EXPECT_FALSE(run_series({series_of({})}).reason.empty());
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const ObservableResult result = run_series({series_of({nan, nan, nan})});
    EXPECT_FALSE(result.measurements.front().value.has_value());
    EXPECT_FALSE(result.measurements.front().reason.empty());
}

}  // namespace
}  // namespace grainfield::analysis
