#include "tracking/detect/disc_correlation.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/support/random.h"
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
    const Image map =
        DiscCorrelation(41, 33, kDisc, 1)
            .chi_squared(padded_darkness(image, kDisc), clear_transmission(41, 33, kDisc));
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
    const Image map = DiscCorrelation(41, 33, kDisc, 1)
                          .gain(padded_darkness(darkness, kDisc), {transmission, 20, 0.0F});
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

TEST(DiscCorrelation, AFifthOfTheImageIsFewPlacesForSumsAndNoMore) {
    const DiscCorrelation correlation(100, 50, kDisc, 2);
    EXPECT_TRUE(correlation.are_few({}));
    EXPECT_TRUE(correlation.are_few({{0, 0, 100, 5}, {0, 20, 50, 30}}));
    EXPECT_FALSE(correlation.are_few({{0, 0, 100, 5}, {0, 20, 51, 30}}));
}

TEST(DiscCorrelation, GainOfAPartIsThatOfTheWhole) {
    const Image darkness = random_image(101, 83, 0, 1, 2);
    const Image transmission = random_image(101, 83, 0.1, 1, 3);
    const PaddedImage d = padded_darkness(darkness, kDisc);
    const PaddedImage t(transmission, 20, 0.0F);
    for (const int factor : {1, 2, 3}) {
        DiscCorrelation correlation(101, 83, kDisc, factor);
        const Image whole = correlation.gain(d, t);
        const std::vector<PixelBlock> places{{0, 0, 13, 13}, {39, 26, 65, 39}, {91, 78, 101, 83}};
        const Image part = correlation.gain_in(places, d, t);
        ASSERT_EQ(part.width(), whole.width());
        for (const PixelBlock& p : places) {
            // One block more on each side.
            const int x1 = std::min(whole.width(), (p.x1 - 1) / factor + 2);
            const int y1 = std::min(whole.height(), (p.y1 - 1) / factor + 2);
            for (int y = std::max(0, p.y0 / factor - 1); y < y1; ++y) {
                for (int x = std::max(0, p.x0 / factor - 1); x < x1; ++x) {
                    EXPECT_NEAR(part(x, y), whole(x, y), 1e-3) << factor << " " << x << " " << y;
                }
            }
        }
        EXPECT_EQ(part(part.width() / 4, part.height() - 2), 0);
    }
}

TEST(DiscCorrelation, FullGainIsWhatAnIsolatedDiscExplains) {
    Image darkness(61, 61);
    for (int y = 0; y < 61; ++y) {
        for (int x = 0; x < 61; ++x) {
            darkness(x, y) = static_cast<float>(kDisc.darkness(std::hypot(x - 30, y - 30)));
        }
    }
    PaddedImage transmission = clear_transmission(61, 61, kDisc);
    const PaddedImage padded = padded_darkness(darkness, kDisc);
    DiscCorrelation correlation(61, 61, kDisc, 1);
    EXPECT_NEAR(correlation.gain(padded, transmission)(30, 30), correlation.full_gain(), 1e-3);
    place_disc(transmission, {30, 30}, kDisc);
    // The kernels cut P below 1e-3, that is all that is left unexplained.
    EXPECT_NEAR(explained_misfit(padded, transmission, {30, 30}, kDisc), correlation.full_gain(),
                1e-3);
}

TEST(DiscCorrelation, BlocksOfPixelsGiveNearlyTheSameMapsAtAFractionOfTheWork) {
    const DiscProfile disc{16, 1.2};
    ASSERT_EQ(DiscCorrelation::suitable_factor(disc), 2);
    const std::vector<Vec2> centres{{40.2, 41.7}, {57.9, 44.1}, {3.1, 60.2}, {96.3, 20.4}};
    PaddedImage model = clear_transmission(101, 99, disc);
    for (const Vec2 c : centres) place_disc(model, c, disc);
    Image darkness = model.inner();
    for (float& v : darkness.pixels()) v = 1 - v;
    const PaddedImage padded = padded_darkness(darkness, disc);
    const PaddedImage clear = clear_transmission(101, 99, disc);
    DiscCorrelation blocks(101, 99, disc, 2);
    DiscCorrelation pixels(101, 99, disc, 1);
    const Image coarse = blocks.gain(padded, clear);
    const Image fine = pixels.gain(padded, clear);
    const Image chi =
        blocks.chi_squared(padded, clear_transmission(padded.width(), padded.height(), kDisc));
    for (int y = 0; y < coarse.height() - 1; ++y) {
        for (int x = 0; x < coarse.width() - 1; ++x) {
            // The centre of a block is the common corner of four pixels.
            const float mean = (fine(2 * x, 2 * y) + fine(2 * x + 1, 2 * y) +
                                fine(2 * x, 2 * y + 1) + fine(2 * x + 1, 2 * y + 1)) /
                               4;
            EXPECT_NEAR(coarse(x, y), mean, 0.05 * pixels.full_gain());
        }
    }
    for (const Vec2 c : centres) {
        const int x = static_cast<int>(std::lround((c.x - 0.5) / 2));
        const int y = static_cast<int>(std::lround((c.y - 0.5) / 2));
        EXPECT_LT(chi(x, y), 0.1) << c.x;
        EXPECT_NEAR(blocks.in_frame({static_cast<double>(x), static_cast<double>(y)}).x, c.x, 1.01);
    }
}

}  // namespace
}  // namespace grainfield::tracking
