#include "analysis/motion/van_hove.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "analysis/motion/displacement.h"
#include "analysis/statistics/blocks.h"
#include "core/errors.h"
#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

ObservableResult of_walk(const DisplacementOptions& options, int frames, double gap,
                         int stride = 1) {
    const Box box = square_box(50);
    Displacement msd(options, frames);
    RandomStream random(1, "walk");
    std::vector<Vec2> points = poisson_points(2000, box, random);
    for (int f = 0; f < frames; ++f) {
        Pattern p;
        p.frame = f;
        p.time = 0.1 * f;
        p.box = box;
        for (std::size_t i = 0; i < points.size(); ++i) {
            points[i] += 0.1 * Vec2{random.normal(), random.normal()};
            if (random.uniform() < gap) continue;
            p.position.push_back(box.wrap(points[i]));
            p.id.push_back(static_cast<std::int64_t>(i));
        }
        if (f % stride == 0) msd.add(std::move(p));
    }
    return msd.result();
}

// 2000 walkers, both axes, 40 − lag starts that overlap: at least 4000 · 40/lag independent steps.
TEST(VanHove, OfABrownianWalkIsGaussian) {
    const ObservableResult r = of_walk({.van_hove = {1, 4}}, 41, 0.1);
    const Curve* curve = r.find_curve("van_hove");
    ASSERT_NE(curve, nullptr);
    ASSERT_EQ(curve->find("x")->values.size(), 2 * van_hove_bins);
    for (std::size_t i = 0; i < curve->find("x")->values.size(); ++i) {
        const double lag = i < van_hove_bins ? 1 : 4;
        EXPECT_NEAR(curve->find("t")->values[i], 0.1 * lag, 1e-9);
        const double sigma = 0.1 * std::sqrt(lag);
        const double x = curve->find("x")->values[i] / sigma;
        const double width = 0.2;
        // Mean of the density over a bin of |x|.
        const double wanted = (std::erf((x + width / 2) / std::numbers::sqrt2) -
                               std::erf((x - width / 2) / std::numbers::sqrt2)) /
                              (2 * width * sigma);
        const double count = 4000 * 30 / lag * 2 * width * sigma * wanted;
        EXPECT_NEAR(curve->find("g")->values[i], wanted,
                    (0.02 + 6 / std::sqrt(count + 1)) * wanted + 1e-3 / sigma)
            << x;
    }
    for (const char* name : {"alpha2_lag_1", "alpha2_lag_4"}) {
        const Measurement* m = r.find_measurement(name);
        // sqrt(24/n)/3 for n Gaussian numbers.
        EXPECT_NEAR(*m->value, 0, 6 * std::sqrt(24.0 / 30000) / 3);
        EXPECT_GT(*m->error, 0);
    }
}

// So many of 16 groups hold displacements, of other widths.
ObservableResult of_groups(int number) {
    std::vector<VanHoveGroup> groups(16, VanHoveGroup{std::vector<double>(van_hove_bins, 0.0)});
    for (int g = 0; g < number; ++g) {
        for (const double x : {0.5, 1.5 + 0.1 * g}) {
            groups[static_cast<std::size_t>(g)].add({x, -x}, 1);
        }
    }
    ObservableResult result;
    add_van_hove_lag(groups, 1, 1, 1, result);
    return result;
}

TEST(VanHove, HasAnErrorWithStudentsFactorFromTheGroupsThatHoldDisplacements) {
    const Measurement m = *of_groups(5).find_measurement("alpha2_lag_1");
    const auto sums = [](int without) {
        double square = 0;
        double fourth = 0;
        double number = 0;
        for (int g = 0; g < 5; ++g) {
            if (g == without) continue;
            for (const double x : {0.5, 1.5 + 0.1 * g}) {
                number += 1;
                square += x * x;
                fourth += x * x * x * x;
            }
        }
        return fourth / number / (3 * std::pow(square / number, 2)) - 1;
    };
    std::vector<double> left;
    for (int g = 0; g < 5; ++g) left.push_back(sums(g));
    EXPECT_NEAR(*m.error, *student_jackknife_error(left), 1e-12);
}

TEST(VanHove, OfThreeGroupsHasAReasonInPlaceOfAnError) {
    const ObservableResult r = of_groups(3);
    EXPECT_FALSE(r.find_measurement("alpha2_lag_1")->error.has_value());
    EXPECT_NE(r.find_measurement("alpha2_lag_1")->reason.find("fewer than four groups"),
              std::string::npos);
    for (const double error : r.find_curve("van_hove")->find("err")->values) {
        EXPECT_TRUE(std::isnan(error));
    }
}

TEST(VanHove, IsThereOnRequestOnly) {
    EXPECT_EQ(of_walk({}, 5, 0).find_curve("van_hove"), nullptr);
    const ObservableResult r = of_walk({.van_hove = {100}}, 5, 0);
    EXPECT_EQ(r.find_curve("van_hove"), nullptr);
    EXPECT_NE(r.find_measurement("alpha2_lag_100")->reason, "");
}

// Every fourth frame is measured: the lag of 8 is that of two of them, and there is none of 2.
TEST(VanHove, AndTheLongestLagCountNumbersOfFramesWhateverTheStep) {
    const ObservableResult all = of_walk({.longest = 8, .van_hove = {8}}, 41, 0);
    const ObservableResult some = of_walk({.longest = 8, .van_hove = {2, 8}}, 41, 0, 4);
    for (const ObservableResult* r : {&all, &some}) {
        EXPECT_NEAR(r->find_curve("van_hove")->find("t")->values.front(), 0.8, 1e-9);
        EXPECT_NEAR(r->find_curve("msd")->find("t")->values.back(), 0.8, 1e-9);
    }
    const ObservableResult few = of_walk({.van_hove = {19, 20}}, 41, 0, 20);
    EXPECT_TRUE(few.find_measurement("alpha2_lag_20")->value.has_value());
    for (const Measurement* m :
         {some.find_measurement("alpha2_lag_2"), few.find_measurement("alpha2_lag_19")}) {
        EXPECT_NE(m->reason.find("no pair"), std::string::npos) << m->name;
    }
}

TEST(VanHove, RefusesLagsThatAreNone) {
    DisplacementOptions options;
    for (const char* lags : {"0", "-1", "x", "1;2", "1.5"}) {
        EXPECT_THROW(describe(options).set("van-hove", std::string(lags)), OptionError) << lags;
    }
    EXPECT_THROW(Displacement({.van_hove = {3, 0}}, 10), OptionError);
    describe(options).set("van-hove", std::string(" 1, 20"));
    EXPECT_EQ(options.van_hove, (std::vector<std::int64_t>{1, 20}));
}

}  // namespace
}  // namespace grainfield::analysis
