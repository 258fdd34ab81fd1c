#include "analysis/bond_statistics.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

TEST(BondStatistics, ReportsTheLatticeSpacingOfACrystal) {
    RandomStream random(1, "spacing");
    BondStatistics statistics({});
    const Pattern p = pattern(square_lattice(50, 0.81, 0.02, random), square_box(50 * 0.81));
    statistics.add(BondStatistics::measure(p, {}));
    const ObservableResult result = statistics.result();
    const Measurement* spacing = result.find_measurement("lattice_spacing");
    ASSERT_TRUE(spacing->value.has_value());
    EXPECT_NEAR(*spacing->value, 0.81, 0.002);
    EXPECT_GT(*spacing->error, 0);
    EXPECT_FALSE(spacing->reason.empty());  // one frame
    EXPECT_FALSE(result.find_measurement("q4_minimum")->value.has_value());
    EXPECT_FALSE(result.find_measurement("q4_minimum")->reason.empty());
}

TEST(BondStatistics, HasAHistogramThatIntegratesToOneAndCountsEveryParticle) {
    RandomStream random(2, "histogram");
    BondStatistics statistics({});
    for (int f = 0; f < 3; ++f) {
        const Box box = square_box(20);
        statistics.add(
            BondStatistics::measure(pattern(poisson_points(400, box, random), box, f), {}));
    }
    const ObservableResult result = statistics.result();
    const Curve* histogram = result.find_curve("q4_histogram");
    double area = 0;
    double count = 0;
    for (double d : histogram->find("density")->values) area += 0.02 * d;
    for (double c : histogram->find("count")->values) count += c;
    EXPECT_NEAR(area, 1, 1e-12);
    EXPECT_EQ(count, 1200);
    EXPECT_EQ(result.find_curve("q4")->find("frame")->values.front(), 2);
    EXPECT_EQ(result.find_curve("q4")->find("q4_re")->values.size(), 400U);
}

TEST(BondStatistics, OfTwoMergedHalvesAreThoseOfTheWhole) {
    RandomStream random(3, "merge");
    const Box box = square_box(20);
    BondStatistics whole({}), first({}), second({});
    for (int f = 0; f < 6; ++f) {
        const auto sample =
            BondStatistics::measure(pattern(poisson_points(300, box, random), box, f), {});
        whole.add(sample);
        (f < 3 ? first : second).add(sample);
    }
    first.merge(second);
    const ObservableResult a = whole.result();
    const ObservableResult b = first.result();
    ASSERT_EQ(a.measurements.size(), b.measurements.size());
    for (std::size_t i = 0; i < a.measurements.size(); ++i) {
        EXPECT_EQ(a.measurements[i].value, b.measurements[i].value);
        EXPECT_EQ(a.measurements[i].error, b.measurements[i].error);
    }
}

TEST(BondStatistics, WithoutParticlesGiveAReason) {
    BondStatistics statistics({});
    EXPECT_FALSE(statistics.result().reason.empty());
    statistics.add(BondStatistics::measure(pattern({}, square_box(5)), {}));
    EXPECT_FALSE(statistics.result().reason.empty());
}

}  // namespace
}  // namespace grainfield::analysis
