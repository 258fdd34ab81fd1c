#include "core/support/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield {
namespace {

// Statistical cases use fixed seeds; a threshold of 5.5 standard deviations has a false-alarm rate
// of 4e-8 for a Gaussian statistic, below 1e-6 for all those of this file together.
constexpr double sigmas = 5.5;
constexpr int draws = 400000;

TEST(Philox, AgreesWithTheKnownAnswersOfRandom123) {
    using Block = std::array<std::uint32_t, 4>;
    EXPECT_EQ(philox_block({0, 0, 0, 0}, {0, 0}),
              (Block{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
    EXPECT_EQ(
        philox_block({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
        (Block{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
    EXPECT_EQ(
        philox_block({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
        (Block{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(RandomStream, IsFixedBySeedNameAndIndexAndByNothingElse) {
    RandomStream a(7, "noise", 3), same(7, "noise", 3);
    RandomStream seed(8, "noise", 3), name(7, "noisf", 3), index(7, "noise", 4);
    int equal = 0;
    for (int i = 0; i < 1000; ++i) {
        const std::uint32_t bits = a.bits();
        ASSERT_EQ(bits, same.bits());
        equal += (bits == seed.bits()) + (bits == name.bits()) + (bits == index.bits());
    }
    // 3000 chances of 2^-32: one coincidence has probability 7e-7.
    EXPECT_EQ(equal, 0);
}

TEST(RandomStream, DoesNotRepeatWithinManyBlocks) {
    RandomStream random(1, "repeat");
    std::vector<std::uint64_t> seen(100000);
    for (auto& value : seen) {
        const std::uint64_t upper = random.bits();
        value = (upper << 32U) | random.bits();
    }
    std::sort(seen.begin(), seen.end());
    // Birthday bound: 1e10 / 2 / 2^64 = 3e-10.
    EXPECT_EQ(std::adjacent_find(seen.begin(), seen.end()), seen.end());
}

TEST(RandomStream, UniformNumbersHaveTheMomentsOfTheUnitInterval) {
    RandomStream random(1, "uniform");
    double sum = 0, squares = 0, lowest = 1, highest = 0;
    for (int i = 0; i < draws; ++i) {
        const double u = random.uniform();
        sum += u;
        squares += u * u;
        lowest = std::min(lowest, u);
        highest = std::max(highest, u);
    }
    EXPECT_GE(lowest, 0);
    EXPECT_LT(highest, 1);
    EXPECT_NEAR(sum / draws, 0.5, sigmas * std::sqrt(1.0 / 12 / draws));
    EXPECT_NEAR(squares / draws, 1.0 / 3, sigmas * std::sqrt(4.0 / 45 / draws));
    const double scaled = random.uniform(-2, 3);
    EXPECT_TRUE(scaled >= -2 && scaled < 3);
}

TEST(RandomStream, NormalNumbersHaveTheFirstFourMomentsOfAGaussian) {
    RandomStream random(1, "normal");
    std::array<double, 5> moment{};
    double neighbours = 0, last = 0;
    for (int i = 0; i < draws; ++i) {
        const double z = random.normal();
        for (std::size_t k = 1; k < moment.size(); ++k) {
            moment[k] += std::pow(z, static_cast<int>(k)) / draws;
        }
        neighbours += z * last / draws;
        last = z;
    }
    // Var(z^k) = E z^2k − (E z^k)²: 1, 2, 15, 96.
    EXPECT_NEAR(moment[1], 0, sigmas * std::sqrt(1.0 / draws));
    EXPECT_NEAR(moment[2], 1, sigmas * std::sqrt(2.0 / draws));
    EXPECT_NEAR(moment[3], 0, sigmas * std::sqrt(15.0 / draws));
    EXPECT_NEAR(moment[4], 3, sigmas * std::sqrt(96.0 / draws));
    EXPECT_NEAR(neighbours, 0, sigmas * std::sqrt(1.0 / draws));
}

TEST(RandomStream, PoissonNumbersHaveEqualMeanAndVarianceInBothAlgorithms) {
    for (const double mean : {0.3, 4.0, 29.9, 30.0, 250.0, 1e6}) {
        RandomStream random(1, "poisson");
        double sum = 0, squares = 0;
        for (int i = 0; i < draws; ++i) {
            const double d = static_cast<double>(random.poisson(mean)) - mean;
            sum += d;
            squares += d * d;
        }
        // Central moments of a Poisson variable: μ2 = m, μ4 = 3m² + m.
        EXPECT_NEAR(sum / draws, 0, sigmas * std::sqrt(mean / draws)) << mean;
        EXPECT_NEAR(squares / draws, mean, sigmas * std::sqrt((2 * mean * mean + mean) / draws))
            << mean;
    }
}

TEST(RandomStream, PoissonFrequenciesAreThoseOfTheDistributionWhereTheAlgorithmChanges) {
    RandomStream random(1, "poisson frequencies");
    constexpr double mean = 30;
    std::vector<int> count(200);
    for (int i = 0; i < draws; ++i) ++count[std::min<std::uint64_t>(random.poisson(mean), 199)];
    double chi2 = 0;
    int cells = 0;
    for (int k = 0; k < 199; ++k) {
        const double p = std::exp(k * std::log(mean) - mean - std::lgamma(k + 1.0));
        const double expected = p * draws;
        if (expected < 25) continue;
        const double d = count[static_cast<std::size_t>(k)] - expected;
        chi2 += d * d / expected;
        ++cells;
    }
    // About 44 cells. Wilson–Hilferty: the 1 − 4e-8 quantile of χ²(m) is m (1 − 2/9m + 5.5 …)³.
    const double m = cells;
    const double limit = m * std::pow(1 - 2 / (9 * m) + sigmas * std::sqrt(2 / (9 * m)), 3);
    EXPECT_GT(cells, 35);
    EXPECT_LT(chi2, limit);
}

TEST(RandomStream, PoissonOfZeroIsZeroAndBadMeansAreRefused) {
    RandomStream random(1, "poisson edge");
    EXPECT_EQ(random.poisson(0), 0U);
    EXPECT_THROW(random.poisson(-1), OptionError);
    EXPECT_THROW(random.poisson(std::nan("")), OptionError);
    EXPECT_THROW(random.poisson(INFINITY), OptionError);
}

TEST(RandomStream, BelowGivesEveryIntegerEquallyOften) {
    RandomStream random(1, "below");
    std::array<int, 7> count{};
    for (int i = 0; i < draws; ++i) ++count.at(random.below(7));
    for (const int n : count) {
        EXPECT_NEAR(n, draws / 7.0, sigmas * std::sqrt(draws * 6.0 / 49));
    }
    EXPECT_EQ(random.below(1), 0U);
    EXPECT_THROW(random.below(0), OptionError);
}

TEST(RandomStream, StreamsOfNeighbouringIndicesAreUncorrelated) {
    double product = 0;
    for (std::uint64_t index = 0; index < draws; ++index) {
        RandomStream a(1, "rows", index), b(1, "rows", index + 1);
        product += (a.uniform() - 0.5) * (b.uniform() - 0.5) / draws;
    }
    EXPECT_NEAR(product, 0, sigmas / 12 / std::sqrt(draws));
}

}  // namespace
}  // namespace grainfield
