#include "simulate/noise.h"

#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "core/support/random.h"

namespace grainfield::simulate {
namespace {

std::array<std::uint32_t, 2> key_of(std::uint64_t seed, const char* name) {
    RandomStream stream(seed, name, 0);
    const std::uint32_t first = stream.bits();
    return {first, stream.bits()};
}

TEST(Noise, WordsAreThoseOfPhilox) {
    const auto key = key_of(7, "some noise");
    const NoiseStream noise(7, "some noise");
    const std::uint64_t step = 0x1234567'9abcdef0ULL;
    for (const std::uint32_t group : {0U, 3U}) {
        std::array<std::uint32_t, 32> words;
        noise.words(step, 11, group, words);
        for (std::uint32_t j = 0; j < 8; ++j) {
            const auto block = philox_block({8 * group + j, 11, 0x9abcdef0U, 0x1234567U}, key);
            EXPECT_EQ(words[2 * j], block[0]);
            EXPECT_EQ(words[2 * j + 1], block[1]);
            EXPECT_EQ(words[16 + 2 * j], block[2]);
            EXPECT_EQ(words[17 + 2 * j], block[3]);
        }
    }
}

TEST(Noise, ANumberDependsOnItsPositionOnly) {
    const NoiseStream noise(1, "x");
    std::vector<float> whole(1000), part(37);
    noise.normal(5, 2, whole);
    noise.normal(5, 2, part);
    EXPECT_TRUE(std::equal(part.begin(), part.end(), whole.begin()));
    noise.uniform(5, 2, whole);
    noise.uniform(5, 2, part);
    EXPECT_TRUE(std::equal(part.begin(), part.end(), whole.begin()));
}

// Rounding may differ by fused operations, nothing else may.
TEST(Noise, EveryInstructionSetGivesTheSameNumbers) {
    const NoiseStream noise(3, "targets");
    std::vector<float> first_uniform, first_normal;
    for (const auto target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        std::vector<float> uniform(777), normal(777);
        noise.uniform(9, 4, uniform);
        noise.normal(9, 4, normal);
        if (first_uniform.empty()) {
            first_uniform = uniform;
            first_normal = normal;
        }
        for (std::size_t i = 0; i < uniform.size(); ++i) {
            EXPECT_NEAR(uniform[i], first_uniform[i], 3e-7F);
            EXPECT_NEAR(normal[i], first_normal[i], 3e-6F);
        }
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

struct Moments {
    double mean = 0, square = 0, fourth = 0, largest = 0, lag = 0;
};

template <class Fill>
Moments moments(std::size_t lines, Fill fill) {
    Moments m;
    std::vector<float> x(4096);
    for (std::size_t line = 0; line < lines; ++line) {
        fill(static_cast<std::uint32_t>(line), x);
        for (std::size_t i = 0; i < x.size(); ++i) {
            const auto v = static_cast<double>(x[i]);
            m.mean += v;
            m.square += v * v;
            m.fourth += v * v * v * v;
            m.lag += v * static_cast<double>(x[(i + 1) % x.size()]);
            m.largest = std::max(m.largest, std::abs(v));
        }
    }
    const double n = static_cast<double>(lines) * static_cast<double>(x.size());
    return {m.mean / n, m.square / n, m.fourth / n, m.largest, m.lag / n};
}

// 5 sigma each: false alarms 6e-7 a comparison.
TEST(Noise, UniformHasMeanZeroAndVarianceOne) {
    const NoiseStream noise(1, "u");
    const std::size_t lines = 1000;
    const double n = lines * 4096.0;
    const Moments m = moments(lines, [&](std::uint32_t l, auto& x) { noise.uniform(1, l, x); });
    EXPECT_NEAR(m.mean, 0, 5 / std::sqrt(n));
    EXPECT_NEAR(m.square, 1, 5 * std::sqrt(0.8 / n));
    EXPECT_NEAR(m.fourth, 1.8, 5 * std::sqrt(81.0 / 9 - 1.8 * 1.8) / std::sqrt(n));
    EXPECT_NEAR(m.lag, 0, 5 / std::sqrt(n));
    EXPECT_LE(m.largest, 1.7320509);
}

TEST(Noise, NormalHasTheMomentsOfAGaussian) {
    const NoiseStream noise(1, "n");
    const std::size_t lines = 1000;
    const double n = lines * 4096.0;
    const Moments m = moments(lines, [&](std::uint32_t l, auto& x) { noise.normal(1, l, x); });
    EXPECT_NEAR(m.mean, 0, 5 / std::sqrt(n));
    EXPECT_NEAR(m.square, 1, 5 * std::sqrt(2 / n));
    EXPECT_NEAR(m.fourth, 3, 5 * std::sqrt(96 / n));
    EXPECT_NEAR(m.lag, 0, 5 / std::sqrt(n));
    EXPECT_GT(m.largest, 4.5);
    EXPECT_LT(m.largest, 6.7);
}

// The exact sum over the 2^16 levels, so no false alarms.
TEST(Noise, TheLevelsOfUniformHaveVarianceOne) {
    double square = 0;
    for (int level = 0; level < 65536; ++level) {
        const float x = static_cast<float>(level) * 5.2857997e-05F - 1.7320244F;
        square += static_cast<double>(x) * static_cast<double>(x) / 65536;
    }
    EXPECT_NEAR(square, 1, 3e-7);  // rounding to float
}

TEST(Noise, StreamsDifferByNameSeedStepAndLine) {
    std::vector<float> a(64), b(64);
    const auto same = [&] { return a == b; };
    NoiseStream(1, "x").normal(0, 0, a);
    NoiseStream(2, "x").normal(0, 0, b);
    EXPECT_FALSE(same());
    NoiseStream(1, "y").normal(0, 0, b);
    EXPECT_FALSE(same());
    NoiseStream(1, "x", 1).normal(0, 0, b);
    EXPECT_FALSE(same());
    NoiseStream(1, "x").normal(1ULL << 32U, 0, b);
    EXPECT_FALSE(same());
    NoiseStream(1, "x").normal(0, 1, b);
    EXPECT_FALSE(same());
    NoiseStream(1, "x").normal(0, 0, b);
    EXPECT_TRUE(same());
}

}  // namespace
}  // namespace grainfield::simulate
