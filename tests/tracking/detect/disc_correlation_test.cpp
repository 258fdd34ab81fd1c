#include "tracking/detect/disc_correlation.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/random.h"
#include "tracking/refine/disc_kernel.h"

namespace grainfield::tracking {
namespace {

const DiscProfile kDisc{8, 1.1};

Image random_image(int width, int height, double low, double high, std::uint64_t seed) {
    RandomStream random(seed, "image");
    Image image(width, height);
    for (float& v : image.pixels()) v = static_cast<float>(random.uniform(low, high));
    return image;
}

double kernel(int x, int y) {
    const int half = static_cast<int>(std::ceil(kDisc.reach()));
    return std::max(std::abs(x), std::abs(y)) <= half ? kDisc.darkness(std::hypot(x, y)) : 0.0;
}

TEST(DiscCorrelation, ChiSquaredEqualsItsDefinitionAlsoAtTheBorder) {
    const Image image = random_image(41, 33, 0, 1, 1);
    const Image map = DiscCorrelation(41, 33, kDisc).chi_squared(image);
    for (const auto& [cx, cy] : {std::pair{0, 0}, {40, 32}, {20, 16}, {3, 30}, {40, 5}}) {
        double numerator = 0;
        double denominator = 0;
        for (int y = 0; y < 33; ++y) {
            for (int x = 0; x < 41; ++x) {
                const double p = kernel(x - cx, y - cy);
                const double d = static_cast<double>(image(x, y)) - p;
                numerator += p * d * d;
                denominator += p * p * p;
            }
        }
        EXPECT_NEAR(map(cx, cy), numerator / denominator, 1e-5);
    }
}

TEST(DiscCorrelation, GainIsTheFallOfTheMisfitWhenOneDiscIsAdded) {
    const Image darkness = random_image(41, 33, 0, 1, 2);
    const Image transmission = random_image(41, 33, 0.1, 1, 3);
    const Image map = DiscCorrelation(41, 33, kDisc).gain(darkness, transmission);
    for (const auto& [cx, cy] : {std::pair{0, 0}, {40, 32}, {20, 16}, {3, 30}}) {
        double gain = 0;
        for (int y = 0; y < 33; ++y) {
            for (int x = 0; x < 41; ++x) {
                const double t = static_cast<double>(transmission(x, y));
                const double r = static_cast<double>(darkness(x, y)) - 1 + t;
                const double after = r - t * kernel(x - cx, y - cy);
                gain += r * r - after * after;
            }
        }
        EXPECT_NEAR(map(cx, cy), gain, 1e-4);
    }
}

TEST(DiscCorrelation, FullGainIsWhatAnIsolatedDiscExplains) {
    Image darkness(61, 61);
    for (int y = 0; y < 61; ++y) {
        for (int x = 0; x < 61; ++x) {
            darkness(x, y) = static_cast<float>(kDisc.darkness(std::hypot(x - 30, y - 30)));
        }
    }
    Image transmission(61, 61, 1.0F);
    DiscCorrelation correlation(61, 61, kDisc);
    EXPECT_NEAR(correlation.gain(darkness, transmission)(30, 30), correlation.full_gain(), 1e-3);
    place_disc(transmission, {30, 30}, kDisc);
    // The kernels cut P below 1e-3, that is all that is left unexplained.
    EXPECT_NEAR(explained_misfit(darkness, transmission, {30, 30}, kDisc), correlation.full_gain(),
                1e-3);
}

}  // namespace
}  // namespace grainfield::tracking
