#include "analysis/histogram_modes.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/random.h"

namespace grainfield::analysis {
namespace {

std::vector<double> mixture(double low_share, std::size_t n, std::uint64_t seed) {
    RandomStream random(seed, "mixture");
    std::vector<double> counts(50, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
        const bool low = random.uniform() < low_share;
        const double x =
            std::abs(low ? 0.33 + 0.13 * random.normal() : 0.95 + 0.03 * random.normal());
        if (x < 1) counts[static_cast<std::size_t>(x * 50)] += 1;
    }
    return counts;
}

TEST(HistogramModes, OfAMixtureAreFoundWithTheMinimumBetween) {
    const HistogramModes modes = find_modes(mixture(0.7, 10000, 1));
    ASSERT_TRUE(modes.minimum.has_value()) << modes.reason;
    EXPECT_NEAR(*modes.low_mode, 0.33, 0.05);
    EXPECT_NEAR(*modes.high_mode, 0.95, 0.03);
    EXPECT_GT(*modes.minimum, 0.65);
    EXPECT_LT(*modes.minimum, 0.87);
    EXPECT_GE(*modes.minimum_error, 0.01);
}

TEST(HistogramModes, OfOnePeakHaveNoMinimumButAReason) {
    const HistogramModes modes = find_modes(mixture(1, 10000, 2));
    EXPECT_FALSE(modes.minimum.has_value());
    EXPECT_FALSE(modes.reason.empty());
    EXPECT_NEAR(*modes.low_mode, 0.33, 0.05);
}

TEST(HistogramModes, AreNotInventedFromCountingNoise) {
    // Some 45 pairs of independent smoothed bins and 6 standard errors: 45 · 2e-9 = 9e-8 a trial,
    // below 1e-6 for ten of them.
    int found = 0;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        RandomStream random(seed, "flat");
        std::vector<double> counts(50);
        for (double& c : counts) c = static_cast<double>(random.poisson(200));
        found += find_modes(counts).minimum.has_value();
    }
    EXPECT_EQ(found, 0);
}

TEST(HistogramModes, OfAnEmptyHistogramGiveAReason) {
    EXPECT_FALSE(find_modes(std::vector<double>(50, 0.0)).reason.empty());
    EXPECT_FALSE(find_modes(std::vector<double>(3, 1.0)).reason.empty());
}

}  // namespace
}  // namespace grainfield::analysis
