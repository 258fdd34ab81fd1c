#include "tracking/refine/misfit_correlation.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tracking/refine/joint_fit.h"

namespace grainfield::tracking {
namespace {

constexpr DiscProfile kDisc{.diameter = 14, .edge_width = 2};

/// Noise of unit variance, averaged over `side` × `side` pixels.
Image noise(int width, int height, int side, std::uint64_t seed) {
    RandomStream random(seed, "noise");
    Image white(width + side, height + side);
    for (float& v : white.pixels()) v = static_cast<float>(random.normal());
    Image mean(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            float sum = 0;
            for (int v = 0; v < side; ++v) {
                for (int u = 0; u < side; ++u) sum += white(x + u, y + v);
            }
            mean(x, y) = 0.05F * sum / static_cast<float>(side);
        }
    }
    return mean;
}

double correlation_of(const Image& image) {
    return misfit_correlation(JointFit(image, kDisc, 1), 0);
}

TEST(MisfitCorrelation, OfWhiteNoiseIsOneToTwoPercent) {
    EXPECT_NEAR(correlation_of(noise(800, 700, 1, 5)), 1, 0.02);
}

// The oracle: the variance of the scores of 1,600 discs over what independent pixels would give.
TEST(MisfitCorrelation, IsTheRatioOfTheVariancesOfTheScore) {
    for (const int side : {2, 4}) {
        const Image image = noise(800, 800, side, 7);
        double squares = 0;
        double expected = 0;
        double variance = 0;
        for (const float v : image.pixels()) variance += static_cast<double>(v * v);
        variance /= static_cast<double>(image.size());
        for (int row = 0; row < 40; ++row) {
            for (int column = 0; column < 40; ++column) {
                double score = 0;
                for (int y = -9; y <= 9; ++y) {
                    for (int x = -9; x <= 9; ++x) {
                        const double r = std::hypot(x, y);
                        const double j = r > 0 ? kDisc.slope(r) * x / r : 0;
                        score +=
                            j * static_cast<double>(image(20 * column + 10 + x, 20 * row + 10 + y));
                        expected += j * j * variance;
                    }
                }
                squares += score * score;
            }
        }
        // Of 1,600 squares the mean is known to 3.5 %.
        EXPECT_NEAR(correlation_of(image) / (squares / expected), 1, 0.1) << side;
    }
}

/// A fit of discs on a square lattice, darkness drawn by another profile, with some noise.
JointFit fitted(const DiscProfile& drawn, double sigma) {
    constexpr int kSide = 600;
    Image image = noise(kSide, kSide, 1, 9);
    for (float& v : image.pixels()) v *= static_cast<float>(sigma / 0.05);
    std::vector<Vec2> centres;
    for (int row = 0; row < 22; ++row) {
        for (int column = 0; column < 22; ++column) {
            centres.push_back({40.3 + 24 * column + 0.37 * row, 40.1 + 24 * row});
        }
    }
    for (const Vec2 c : centres) {
        const int x0 = static_cast<int>(c.x);
        const int y0 = static_cast<int>(c.y);
        for (int y = y0 - 18; y <= y0 + 18; ++y) {
            for (int x = x0 - 18; x <= x0 + 18; ++x) {
                image(x, y) += static_cast<float>(drawn.darkness(std::hypot(x - c.x, y - c.y)));
            }
        }
    }
    JointFit fit(image, kDisc, 1);
    fit.add_all(centres);
    fit.refine({});
    return fit;
}

TEST(MisfitCorrelation, KnowsTheWhiteNoiseBesideTheMisfit) {
    Image image = noise(800, 800, 4, 7);
    const double alone = correlation_of(image);
    const Image white = noise(800, 800, 1, 8);
    for (std::size_t i = 0; i < image.size(); ++i) image.pixels()[i] += white.pixels()[i];
    const JointFit both(image, kDisc, 1);
    EXPECT_NEAR(misfit_correlation(both, 0.05) / alone, 1, 0.1);
    EXPECT_LT(misfit_correlation(both, 0) / alone, 0.7);
}

TEST(MisfitCorrelation, OfDiscsOfTheRightProfileIsOne) {
    EXPECT_NEAR(misfit_correlation(fitted(kDisc, 0.02), 0), 1, 0.03);
    EXPECT_EQ(misfit_correlation(fitted(kDisc, 0.02), 0.02), 1);
}

TEST(MisfitCorrelation, OfDiscsOfAWrongSizeLiesAtTheEdges) {
    const JointFit fit = fitted({.diameter = 13, .edge_width = 2}, 0.005);
    EXPECT_GT(misfit_at_edges(fit), 1.2);
    EXPECT_GT(misfit_correlation(fit, 0.005), 2);
}

TEST(MisfitCorrelation, OfAFrameTooSmallToTellIsOne) {
    EXPECT_EQ(correlation_of(noise(50, 300, 4, 3)), 1);
}

}  // namespace
}  // namespace grainfield::tracking
