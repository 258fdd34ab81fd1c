#include "tracking/score/detection_scores.h"

#include <cmath>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/support/random.h"

namespace grainfield::tracking {
namespace {

TEST(DetectionScores, CountByHand) {
    DetectionScores scores({"all", "crystal"}, 2);
    // Two of three found, one of them in the crystal; the false one is nearest to the crystal.
    const TruthFrame truth{{{10, 10}, {20, 20}, {30, 30}}, {1, 1, 3}, {}};
    const FrameMatch match = scores.add(truth, {{10.3, 10}, {29.8, 30.4}, {35, 35}}, {});
    EXPECT_EQ(match.partner, (std::vector<int>{0, -1, 1}));
    EXPECT_EQ(match.classes, (std::vector<std::uint64_t>{1, 3, 3}));
    const ClassScore& all = scores.find("all");
    EXPECT_EQ(all.matched, 2);
    EXPECT_EQ(all.missed, 1);
    EXPECT_EQ(all.spurious, 1);
    EXPECT_DOUBLE_EQ(all.recall(), 2.0 / 3);
    EXPECT_DOUBLE_EQ(all.precision(), 2.0 / 3);
    EXPECT_DOUBLE_EQ(all.jaccard(), 2.0 / 4);
    EXPECT_NEAR(all.bias().x, 0.05, 1e-12);
    EXPECT_NEAR(all.bias().y, 0.2, 1e-12);
    EXPECT_NEAR(all.rmse().x, std::sqrt((0.09 + 0.04) / 2), 1e-12);
    EXPECT_NEAR(all.rmse_per_axis(), std::sqrt((0.09 + 0.04 + 0.16) / 4), 1e-12);
    const ClassScore& crystal = scores.find("crystal");
    EXPECT_EQ(crystal.matched, 1);
    EXPECT_EQ(crystal.missed, 0);
    EXPECT_EQ(crystal.spurious, 1);
    EXPECT_TRUE(std::isnan(all.bound_ratio())) << "no bounds were given";
}

TEST(DetectionScores, WhoBelongsToNoClassMayBeMatchedAndCountsNowhere) {
    DetectionScores scores({"all"}, 2);
    const FrameMatch match =
        scores.add({{{1, 1}, {50, 50}}, {0, 1}, {}}, {{1, 1}, {2.5, 2.5}, {50, 50}}, {});
    EXPECT_EQ(match.classes, (std::vector<std::uint64_t>{0, 0, 1}));
    EXPECT_EQ(scores.find("all").matched, 1);
    EXPECT_EQ(scores.find("all").missed, 0);
    EXPECT_EQ(scores.find("all").spurious, 0) << "the false one is nearest to the one left out";
}

TEST(DetectionScores, OnFramesWithoutTruthEverythingFoundIsSpurious) {
    DetectionScores scores({"all"}, 2);
    scores.add({}, {{1, 1}, {2, 2}}, {});
    scores.add({}, {}, {});
    EXPECT_EQ(scores.frames(), 2);
    EXPECT_EQ(scores.find("all").spurious, 2);
    EXPECT_EQ(scores.find("all").precision(), 0);
    EXPECT_TRUE(std::isnan(scores.find("all").recall()));
}

TEST(DetectionScores, CountsAgreeWithBruteForce) {
    DetectionScores scores({"all"}, 1.5);
    std::int64_t matched = 0;
    double squares = 0;
    for (std::uint64_t frame = 0; frame < 20; ++frame) {
        RandomStream random(5, "points", frame);
        std::vector<Vec2> truth, found;
        for (int i = 0; i < 60; ++i)
            truth.push_back({random.uniform(0, 30), random.uniform(0, 30)});
        for (int i = 0; i < 55; ++i)
            found.push_back({random.uniform(0, 30), random.uniform(0, 30)});
        scores.add({truth, std::vector<std::uint64_t>(60, 1), {}}, found, {});
        // Again and again the nearest of all pairs that are still free.
        std::set<std::size_t> free_true, free_found;
        for (std::size_t i = 0; i < 60; ++i) free_true.insert(i);
        for (std::size_t j = 0; j < 55; ++j) free_found.insert(j);
        for (;;) {
            double least = 1.5 * 1.5;
            std::size_t a = 60, b = 0;
            for (const std::size_t i : free_true) {
                for (const std::size_t j : free_found) {
                    const double d2 = squared_norm(truth[i] - found[j]);
                    if (d2 > least) continue;
                    least = d2;
                    a = i;
                    b = j;
                }
            }
            if (a == 60) break;
            free_true.erase(a);
            free_found.erase(b);
            ++matched;
            squares += least;
        }
    }
    const ClassScore& all = scores.find("all");
    EXPECT_EQ(all.matched, matched);
    EXPECT_EQ(all.missed, 20 * 60 - matched);
    EXPECT_EQ(all.spurious, 20 * 55 - matched);
    EXPECT_NEAR(all.rmse_per_axis(), std::sqrt(squares / (2.0 * static_cast<double>(matched))),
                1e-12);
}

/// Normal errors whose standard error is the bound times `excess`, reported as the bound.
DetectionScores with_errors(double excess, double locking, int particles = 20000) {
    DetectionScores scores({"all"}, 4);
    RandomStream random(9, "errors");
    TruthFrame truth;
    std::vector<Vec2> found;
    for (int i = 0; i < particles; ++i) {
        const Vec2 at{20.0 * (i % 100) + random.uniform(), 20.0 * (i / 100) + random.uniform()};
        const double bound = i % 2 == 0 ? 0.01 : 0.05;
        const double pull = locking * std::sin(2 * std::numbers::pi * at.x);
        truth.position.push_back(at);
        truth.classes.push_back(1);
        truth.bound.push_back({bound, bound});
        found.push_back(
            at + Vec2{excess * bound * random.normal() + pull, excess * bound * random.normal()});
    }
    const std::vector<Vec2> reported = truth.bound;
    scores.add(truth, found, reported);
    return scores;
}

TEST(DetectionScores, RecoverTheRatioToTheBoundAndThePulls) {
    const DetectionScores scores = with_errors(1.3, 0);
    const ClassScore& all = scores.find("all");
    EXPECT_EQ(all.resolved, 20000);
    EXPECT_NEAR(all.bound(), std::sqrt((0.01 * 0.01 + 0.05 * 0.05) / 2), 1e-12);
    // 5σ of an RMS of 20,000 (mostly the 20,000 errors with the wide bound): 1.3 · 5/√40,000.
    EXPECT_NEAR(all.bound_ratio(), 1.3, 0.033);
    EXPECT_NEAR(all.pull_rms(), 1.3, 0.024);
    // erf(2/1.3/√2), 5σ of a share of 40,000.
    EXPECT_NEAR(all.within_two_sigma(), 0.8760, 0.0083);
    std::int64_t counted = scores.pulls_beyond();
    for (const std::int64_t n : scores.pull_histogram()) counted += n;
    EXPECT_EQ(counted, 40000);
    EXPECT_LT(scores.pulls_beyond(), 3) << "beyond 6/1.3 standard deviations: 0.16 expected";
}

TEST(DetectionScores, AnErrorBarOfThePixelLockingCoversWhatChanceGives) {
    const DetectionScores scores = with_errors(1, 0);
    const auto locking = scores.pixel_locking(0);
    // Σ 1/b² = 10,400/0.01²: a mean has the error 0.01/√10,400, a harmonic √2 of it.
    EXPECT_NEAR(locking.error, 0.01 * std::sqrt(2.0 / 10400), 4e-6);
    EXPECT_LT(locking.amplitude, 5.3 * locking.error);  // exp(−5.3²/2) < 1e-6
}

TEST(DetectionScores, FindTheAmplitudeOfPixelLockingAlongItsAxisOnly) {
    const DetectionScores scores = with_errors(1, 0.02);
    const auto x = scores.pixel_locking(0);
    EXPECT_NEAR(x.amplitude, 0.02, 5 * x.error + 1e-4);
    EXPECT_NEAR(x.rms, 0.02 / std::sqrt(2.0), 0.001);
    EXPECT_LT(scores.pixel_locking(1).amplitude, 5.3 * scores.pixel_locking(1).error);
    const auto curve = scores.phase_curve(0);
    ASSERT_EQ(curve.size(), 20U);
    EXPECT_NEAR(curve[14].mean, 0.02 * std::sin(2 * std::numbers::pi * 0.225), 0.003);
    EXPECT_NEAR(curve[5].mean, 0.02 * std::sin(2 * std::numbers::pi * -0.225), 0.003);
}

TEST(DetectionScores, ParticlesThatTheGateWouldCutDoNotEnterTheRatio) {
    DetectionScores scores({"all"}, 3);
    const double none = std::nan("");
    scores.add({{{10, 10}, {30, 30}, {50, 50}}, {1, 1, 1}, {{0.1, 0.1}, {1.5, 0.1}, {none, none}}},
               {{10.1, 9.9}, {32, 30}, {50, 50}}, {{0.2, 0.2}, {0.2, 0.2}, {none, none}});
    const ClassScore& all = scores.find("all");
    EXPECT_EQ(all.matched, 3);
    EXPECT_EQ(all.resolved, 1);
    EXPECT_NEAR(all.bound_ratio(), 1, 1e-9);
    EXPECT_EQ(all.pulls, 2);
    EXPECT_NEAR(all.pull_rms(), 0.5, 1e-9);
    EXPECT_EQ(all.within_two_sigma(), 1);
}

TEST(DetectionScores, WithoutReportedErrorsKnowNoShareWithinThem) {
    DetectionScores scores({"all"}, 3);
    const double none = std::nan("");
    scores.add({{{10, 10}}, {1}, {{none, none}}}, {{10, 10}}, {{none, none}});
    EXPECT_EQ(scores.find("all").matched, 1);
    EXPECT_TRUE(std::isnan(scores.find("all").within_two_sigma()));
}

TEST(DetectionScores, RefuseWhatDoesNotFit) {
    EXPECT_THROW(DetectionScores({}, 2), OptionError);
    EXPECT_THROW(DetectionScores({"all"}, 0), OptionError);
    DetectionScores scores({"all"}, 2);
    EXPECT_THROW(scores.add({{{1, 1}}, {}, {}}, {}, {}), InputError);
    EXPECT_THROW(scores.add({{{1, 1}}, {1}, {{1, 1}, {1, 1}}}, {}, {}), InputError);
    EXPECT_THROW(scores.add({}, {{1, 1}}, {{1, 1}, {1, 1}}), InputError);
    EXPECT_THROW(scores.find("liquid"), OptionError);
}

}  // namespace
}  // namespace grainfield::tracking
