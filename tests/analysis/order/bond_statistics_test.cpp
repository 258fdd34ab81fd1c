#include "analysis/order/bond_statistics.h"

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

// Frames of independent particles: 40 histograms of 20 frames scatter about their mean as their
// errors say. 40 × 40 bins: the mean square pull is 1 within 0.2, six of its standard errors.
TEST(BondStatistics, HaveAHistogramWhoseErrorsAreTheScatterOfSuchRuns) {
    constexpr int runs = 40;
    std::vector<std::vector<double>> density;
    std::vector<std::vector<double>> error;
    for (int run = 0; run < runs; ++run) {
        RandomStream random(4, "histogram errors", static_cast<std::uint64_t>(run));
        BondStatistics statistics({});
        for (int f = 0; f < 20; ++f) {
            BondStatistics::Sample sample;
            BondOrderField field;
            sample.frame = f;
            for (int i = 0; i < 300; ++i) {
                sample.id.push_back(i);
                field.q.emplace_back(0.9 * random.uniform(), 0.0);
            }
            field.nearest.assign(300, 1.0);
            field.mean_four.assign(300, 1.0);
            field.neighbours.assign(300, 0);
            field.first.assign(300, 0);
            sample.field = std::make_shared<const BondOrderField>(std::move(field));
            statistics.add(std::move(sample));
        }
        const ObservableResult result = statistics.result();
        const Curve* histogram = result.find_curve("q4_histogram");
        density.push_back(histogram->find("density")->values);
        error.push_back(histogram->find("err")->values);
    }
    double squares = 0;
    int count = 0;
    for (std::size_t b = 0; b < 40; ++b) {
        double mean = 0;
        for (const auto& of_run : density) mean += of_run[b] / runs;
        for (std::size_t run = 0; run < density.size(); ++run) {
            const double pull = (density[run][b] - mean) / error[run][b];
            squares += pull * pull * runs / (runs - 1.0);
            ++count;
        }
    }
    EXPECT_NEAR(squares / count, 1, 0.2);
    EXPECT_EQ(error[0][48], 0) << "a bin that no particle is in";
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

// Half a jittered square lattice and half a gas, with |Q4| of two modes.
std::vector<Vec2> two_phases(RandomStream& random) {
    std::vector<Vec2> points = square_lattice(60, 1, 0.09, random);
    std::erase_if(points, [](Vec2 p) { return p.x > 30; });
    while (points.size() < 3600) {
        points.push_back({30.5 + 29.5 * random.uniform(), 60 * random.uniform()});
    }
    return points;
}

TEST(BondStatistics, CountsFramesThatRepeatOneAnotherOnce) {
    // 40 frames that are one and the same pattern, 40 that show each of 10 patterns four times in a
    // row, and 40 different ones.
    RandomStream random(4, "repeat");
    const Box box = square_box(60, Boundary::walls);
    BondStatistics same({}), repeated({}), different({});
    const auto make = [&](int f) {
        return BondStatistics::measure(pattern(two_phases(random), box, f), {});
    };
    const auto first = make(0);
    auto shown = first;
    for (int f = 0; f < 40; ++f) {
        same.add(first);
        if (f % 4 == 0) shown = make(f);
        repeated.add(shown);
        different.add(make(f));
    }
    const double particles = 3600;
    const auto samples = [](const BondStatistics& s) {
        return s.result().find_measurement("q4_low_mode")->samples;
    };
    const auto error = [](const BondStatistics& s) {
        return *s.result().find_measurement("q4_low_mode")->error;
    };
    // Neighbours share neighbours, so that particles are not quite independent either: the scatter
    // from frame to frame sees it. Where nothing changes it cannot be seen, and one frame's worth
    // is left, up to the noise that 39 changes in some ten bins could hide: 2 sqrt(2/390) = 14 %.
    EXPECT_GE(samples(same), particles);
    EXPECT_LT(samples(same), particles / (1 - 0.14) * 1.02);
    EXPECT_LT(samples(repeated), 0.4 * samples(different));
    EXPECT_GT(samples(repeated), 0.15 * samples(different));
    EXPECT_GT(samples(different), 20 * particles);
    EXPECT_LE(samples(different), 40 * particles);
    EXPECT_GT(error(repeated), 1.4 * error(different));
}

TEST(BondStatistics, CallsItsNumbersAfterTheSymmetry) {
    RandomStream random(5, "six");
    const BondOrderOptions six{.symmetry = 6};
    BondStatistics statistics(six);
    const Pattern p = pattern(square_lattice(20, 1, 0.02, random), square_box(20));
    statistics.add(BondStatistics::measure(p, six));
    const ObservableResult result = statistics.result();
    EXPECT_NE(result.find_measurement("q6_mean"), nullptr);
    EXPECT_EQ(result.find_measurement("q4_mean"), nullptr);
    EXPECT_EQ(result.find_measurement("q6_mean")->samples, 400);
    EXPECT_EQ(result.find_curve("q4_histogram")->title, "Distribution of |Q6|");
}

}  // namespace
}  // namespace grainfield::analysis
