#include "analysis/statistics/blocks.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::analysis {
namespace {

TEST(BlockPlan, CutsFramesIntoConsecutiveBlocksOfNearlyEqualLength) {
    const BlockPlan plan = BlockPlan::of(100, 16);
    std::vector<int> frames(16, 0);
    int last = 0;
    for (int i = 0; i < 100; ++i) {
        const int block = plan.block_of(i);
        EXPECT_GE(block, last);
        last = block;
        ++frames[static_cast<std::size_t>(block)];
    }
    for (int n : frames) EXPECT_TRUE(n == 6 || n == 7);
}

TEST(BlockPlan, HasNoMoreBlocksThanFrames) {
    EXPECT_EQ(BlockPlan::of(3).blocks, 3);
    EXPECT_EQ(BlockPlan::of(0).blocks, 1);
    EXPECT_EQ(BlockPlan::of(3).block_of(99), 2);
}

TEST(BlockPlan, OfALongerRunTakesWholeBlocksTogether) {
    for (const std::int64_t planned : {5, 16, 40, 100}) {
        const BlockPlan plan = BlockPlan::of(planned);
        EXPECT_EQ(plan.lengthened(planned / 2), plan) << "shorter";
        for (const std::int64_t frames : {planned + 1, 2 * planned, 7 * planned + 3}) {
            const BlockPlan longer = plan.lengthened(frames);
            EXPECT_GE(longer.frames, frames);
            EXPECT_LE(longer.blocks, 16);
            EXPECT_GE(longer.block_of(frames - 1), std::min<std::int64_t>(frames, 8) - 1);
            for (std::int64_t i = 0; i < planned; ++i) {
                const std::int64_t first = plan.first_of(plan.block_of(i));
                EXPECT_EQ(longer.block_of(i), longer.block_of(first)) << planned << " " << i;
            }
        }
    }
}

TEST(Jackknife, OfAMeanIsTheUsualStandardError) {
    const std::vector<double> x{1, 4, 2, 8, 5, 7};
    double sum = 0;
    for (double v : x) sum += v;
    std::vector<double> left;
    double squares = 0;
    for (double v : x) {
        left.push_back((sum - v) / 5);
        squares += (v - sum / 6) * (v - sum / 6);
    }
    EXPECT_NEAR(*jackknife_error(left), std::sqrt(squares / 5 / 6), 1e-14);
}

TEST(Jackknife, RefusesTooFewValues) {
    EXPECT_FALSE(jackknife_error(std::vector<double>{1, 2}).has_value());
    EXPECT_FALSE(jackknife_error(std::vector<double>{1, 2, std::nan("")}).has_value());
}

TEST(Jackknife, WithStudentsFactorIsWiderByTheSpreadOfT) {
    const std::vector<double> left{1, 2, std::nan(""), 4, 4.5};
    EXPECT_NEAR(*student_jackknife_error(left), std::sqrt(3.0) * *jackknife_error(left), 1e-14);
}

TEST(Jackknife, WithStudentsFactorAsksForFourBlocks) {
    const std::vector<double> left{1, 2, 4};
    EXPECT_FALSE(student_jackknife_error(left).has_value());
    EXPECT_FALSE(student_jackknife_error(left, 2).has_value());
    EXPECT_FALSE(student_jackknife_error(std::vector<double>{1, 2, 4, 5}, 8).has_value());
}

// Means of blocks of so many values, each `keep` correlated with the next.
std::vector<double> block_means_of(const std::vector<double>& frames, double keep,
                                   RandomStream& random) {
    std::vector<double> means;
    double x = random.normal();
    for (const double f : frames) {
        double sum = 0;
        for (int i = 0; i < static_cast<int>(f); ++i) {
            sum += x;
            x = keep * x + std::sqrt(1 - keep * keep) * random.normal();
        }
        means.push_back(sum / f);
    }
    return means;
}

double weighted_mean(const std::vector<double>& frames, const std::vector<double>& means) {
    double sum = 0, all = 0;
    for (std::size_t b = 0; b < means.size(); ++b) {
        sum += frames[b] * means[b];
        all += frames[b];
    }
    return sum / all;
}

TEST(BlockDrift, TellsTheVarianceOfTheMeanOfWhatRelaxesExponentially) {
    // Blocks of 20 values, 40, 4 and 1.3 relaxation times long, and 13 blocks of unequal length.
    struct Run {
        std::vector<double> frames;
        double keep;
    };
    std::vector<Run> runs;
    for (const double time : {0.5, 5.0, 15.0}) {
        runs.push_back({std::vector<double>(16, 20.0), std::exp(-1 / time)});
    }
    std::vector<double> unequal(12, 20.0);
    unequal.push_back(3);
    runs.push_back({unequal, std::exp(-1.0 / 5)});
    for (const auto& [frames, keep] : runs) {
        RandomStream random(4, "drift", static_cast<std::uint64_t>(1000 * keep) + frames.size());
        constexpr int series = 20000;
        BlockScatter scatter;
        double of_mean = 0;
        for (int i = 0; i < series; ++i) {
            const std::vector<double> means = block_means_of(frames, keep, random);
            add_scatter<double>(scatter, frames, means);
            of_mean += std::pow(weighted_mean(frames, means), 2) / series;
        }
        scatter.squares /= series;
        scatter.steps /= series;
        // Known to sqrt(2/20000) = 1 %; six of them.
        EXPECT_NEAR(block_drift(scatter, frames.size()).variance_of_mean, of_mean, 0.06 * of_mean)
            << keep << ", " << frames.size() << " blocks";
    }
}

TEST(BlockDrift, OfIndependentFramesHasARatioOfOneInBlocksOfAnyLength) {
    for (const double last : {100.0, 30.0, 1.0}) {
        std::vector<double> frames(15, 100.0);
        frames.push_back(last);
        RandomStream random(5, "unequal", static_cast<std::uint64_t>(last));
        BlockScatter scatter;
        for (int i = 0; i < 2000; ++i) {
            add_scatter<double>(scatter, frames, block_means_of(frames, 0, random));
        }
        // Each ratio scatters by some 1/4: six standard errors.
        EXPECT_NEAR(block_drift(scatter, 16).step_ratio, 1, 6 * 0.25 / std::sqrt(2000)) << last;
    }
}

TEST(BlockDrift, OfIndependentMeansIsTheirVarianceOverTheirNumber) {
    const BlockDrift drift = block_drift({45, 100}, 13);
    EXPECT_DOUBLE_EQ(drift.step_ratio, 100.0 / 90);
    EXPECT_DOUBLE_EQ(drift.variance_of_mean, 45.0 / 156);
    EXPECT_EQ(drift.excess, 1);
}

TEST(BlockDrift, CorrectsFromTwelveBlocksOnAndJudgesFromEight) {
    EXPECT_GT(block_drift({1, 1.4}, 12).excess, 1.5);
    EXPECT_EQ(block_drift({1, 1.4}, 11).excess, 1);
    EXPECT_DOUBLE_EQ(block_drift({1, 0.4}, 8).step_ratio, 0.2);
    EXPECT_EQ(block_drift({1, 0.4}, 7).step_ratio, 1);
}

TEST(BlockDrift, OfAStraightLineIsFarBelowTheLeastRatio) {
    BlockScatter scatter;
    std::vector<double> line;
    for (int b = 0; b < 16; ++b) line.push_back(b);
    add_scatter<double>(scatter, std::vector<double>(16, 5.0), line);
    EXPECT_DOUBLE_EQ(scatter.squares, 340);
    EXPECT_DOUBLE_EQ(scatter.steps, 15);
    const BlockDrift drift = block_drift(scatter, 16);
    EXPECT_LT(drift.step_ratio, 0.1 * least_step_ratio);
    EXPECT_TRUE(std::isfinite(drift.variance_of_mean));
}

TEST(BlockDrift, OfEqualMeansThatAreNoExactNumbersIsNone) {
    BlockScatter scatter;
    add_scatter<double>(scatter, std::vector<double>(16, 3.0), std::vector<double>(16, 1.0 / 3));
    EXPECT_EQ(scatter.squares, 0);
    EXPECT_EQ(scatter.steps, 0);
    EXPECT_EQ(block_drift(scatter, 16).variance_of_mean, 0);
    EXPECT_EQ(block_drift(scatter, 16).step_ratio, 1);
}

TEST(BlockDrift, LeavesFewerFramesBehindAMeanOfBlocksThatAreAlike) {
    EXPECT_DOUBLE_EQ(frames_of_mean(100, BlockDrift{}), 101);
    EXPECT_DOUBLE_EQ(frames_of_mean(100, {0.8, 1, 4}), 26);
}

TEST(MeanSeries, GivesAReasonInsteadOfANumberWhenEmpty) {
    const Measurement m = MeanSeries{}.measurement("x", "-", std::nullopt, "nothing seen");
    EXPECT_FALSE(m.value.has_value());
    EXPECT_EQ(m.reason, "nothing seen");
}

TEST(MeanSeries, HasAnErrorThatCoversTheTruthWithinSixStandardErrors) {
    // 400 independent normals in 16 blocks: |t| with 15 degrees of freedom above 9 has p < 2e-7.
    RandomStream random(1, "mean series");
    MeanSeries series;
    for (int i = 0; i < 400; ++i) series.add(5 + random.normal());
    const Measurement m = series.measurement("x", "-", std::nullopt, "");
    // error²/0.05² is χ² of 15 degrees over 15: inside [0.08, 4.4] but for 1e-6.
    EXPECT_GT(*m.error, 0.05 * std::sqrt(0.08));
    EXPECT_LT(*m.error, 0.05 * std::sqrt(4.4));
    EXPECT_LT(std::abs(*m.value - 5), 9 * *m.error);
}

TEST(MeanSeries, CountsIndependentFramesNotBlocks) {
    // Every value 25 times in a row: 4000 frames hold 160 independent ones. From 16 blocks the
    // number is known to sqrt(2/15) = 37 %; averaged over 100 runs to 4 % (its mean is 15/13 times
    // the truth, that of an inverse χ²).
    RandomStream random(2, "independent frames");
    double repeated = 0;
    double different = 0;
    for (int run = 0; run < 100; ++run) {
        MeanSeries slow;
        MeanSeries fast;
        double x = 0;
        for (int i = 0; i < 4000; ++i) {
            if (i % 25 == 0) x = random.normal();
            slow.add(x);
            fast.add(random.normal());
        }
        repeated += slow.measurement("x", "-", std::nullopt, "").samples / 100;
        different += fast.measurement("x", "-", std::nullopt, "").samples / 100;
    }
    EXPECT_NEAR(repeated, 160 * 15.0 / 13, 0.25 * 160);
    EXPECT_GT(different, 2500);
    EXPECT_LE(different, 4000);
}

TEST(MeanSeries, OfEqualValuesHasAReasonInPlaceOfAnErrorOfZero) {
    MeanSeries series;
    for (int i = 0; i < 30; ++i) series.add(0.1);
    const Measurement m = series.measurement("x", "-", std::nullopt, "");
    EXPECT_FALSE(m.error.has_value());
    EXPECT_NE(m.reason.find("same in every frame"), std::string::npos);
    EXPECT_NEAR(*m.value, 0.1, 1e-15);
}

}  // namespace
}  // namespace grainfield::analysis
