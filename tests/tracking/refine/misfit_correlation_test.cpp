#include "tracking/refine/misfit_correlation.h"

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tracking/model/visible_pixels.h"
#include "tracking/refine/joint_fit.h"

namespace grainfield::tracking {
namespace {

constexpr DiscProfile kDisc{.diameter = 14, .edge_width = 2};

/// Noise of standard deviation .05, averaged over `side` × `side` pixels and scaled back to it.
Image noise(int size, int side, std::uint64_t seed) {
    RandomStream random(seed, "noise");
    Image white(size + side, size + side);
    for (float& v : white.pixels()) v = static_cast<float>(random.normal());
    Image mean(size, size);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            float sum = 0;
            for (int v = 0; v < side; ++v) {
                for (int u = 0; u < side; ++u) sum += white(x + u, y + v);
            }
            mean(x, y) = 0.05F * sum / static_cast<float>(side);
        }
    }
    return mean;
}

std::vector<Vec2> lattice(int size, double spacing) {
    std::vector<Vec2> centres;
    for (double y = 40.1; y < size - 40; y += spacing) {
        for (double x = 40.3; x < size - 40; x += spacing) centres.push_back({x + 0.03 * y, y});
    }
    std::erase_if(centres, [&](Vec2 c) { return c.x > size - 40; });
    return centres;
}

Image with_discs(Image image, const std::vector<Vec2>& centres, const DiscProfile& disc) {
    for (const Vec2 c : centres) {
        const int x0 = static_cast<int>(c.x);
        const int y0 = static_cast<int>(c.y);
        for (int y = y0 - 18; y <= y0 + 18; ++y) {
            for (int x = x0 - 18; x <= x0 + 18; ++x) {
                image(x, y) += static_cast<float>(disc.darkness(std::hypot(x - c.x, y - c.y)));
            }
        }
    }
    return image;
}

/// κ of this residual about discs far apart that stand where they belong.
double correlation_of(const Image& residual, double white, VisiblePixels visible = {}) {
    const std::vector<Vec2> centres = lattice(residual.width(), 60);
    const Image image = with_discs(residual, centres, kDisc);
    JointFit fit(image, kDisc, 1);
    fit.set_visible(std::move(visible));
    fit.restart(image);
    fit.add_all(centres);
    return misfit_correlation(fit, white, fit.residuals());
}

/// The oracle: the variance of the scores of 1,600 discs over what independent pixels would give.
double ratio_of_scores(const Image& image) {
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
    return squares / expected;
}

/// Discs that were fitted to an image which may have another profile.
JointFit fitted(const DiscProfile& drawn, double sigma) {
    Image image = noise(600, 1, 9);
    for (float& v : image.pixels()) v *= static_cast<float>(sigma / 0.05);
    const std::vector<Vec2> centres = lattice(600, 24);
    JointFit fit(with_discs(std::move(image), centres, drawn), kDisc, 1);
    fit.add_all(centres);
    fit.refine({});
    return fit;
}

// With discs 60 px apart a twentieth is put back that no fit has taken. 1,600 squared scores tell
// their mean to 3.5 %, those of 150 places to some 8 %.
TEST(MisfitCorrelation, IsTheRatioOfTheVariancesOfTheScore) {
    for (const int side : {2, 4}) {
        const Image image = noise(800, side, 7);
        EXPECT_NEAR(correlation_of(image, 0) / ratio_of_scores(image), 1.05, 0.2) << side;
    }
}

TEST(MisfitCorrelation, KnowsTheWhiteNoiseBesideTheMisfit) {
    Image both = noise(800, 4, 7);
    const double alone = correlation_of(both, 0);
    const Image white = noise(800, 1, 8);
    for (std::size_t i = 0; i < both.size(); ++i) both.pixels()[i] += white.pixels()[i];
    EXPECT_NEAR(correlation_of(both, 0.05) / alone, 1, 0.15);
    EXPECT_LT(correlation_of(both, 0) / alone, 0.7);
}

TEST(MisfitCorrelation, HiddenPixelsDoNotCount) {
    const Image image = noise(800, 4, 7);
    Image mask(800, 800, 1);
    for (int y = 0; y < 800; ++y) {
        for (int x = 0; x < 800; ++x) mask(x, y) = (x / 100 + y / 100) % 4 == 0 ? 0.0F : 1.0F;
    }
    EXPECT_NEAR(correlation_of(image, 0, VisiblePixels(mask)) / correlation_of(image, 0), 1, 0.2);
}

TEST(MisfitCorrelation, OfDiscsOfTheRightProfileIsOne) {
    const JointFit fit = fitted(kDisc, 0.02);
    EXPECT_NEAR(misfit_correlation(fit, 0, fit.residuals()), 1, 0.06);
    EXPECT_EQ(misfit_correlation(fit, 0.02, fit.residuals()), 1);
}

TEST(MisfitCorrelation, OfDiscsOfAWrongSizeIsLarge) {
    const JointFit fit = fitted({.diameter = 13, .edge_width = 2}, 0.005);
    EXPECT_GT(misfit_correlation(fit, 0.005, fit.residuals()), 3);
}

TEST(MisfitCorrelation, OfAFrameTooSmallToTellIsOne) {
    const Image image = noise(28, 4, 3);
    JointFit fit(image, kDisc, 1);
    fit.add({14, 14});
    EXPECT_EQ(misfit_correlation(fit, 0, fit.residuals()), 1);
    EXPECT_EQ(misfit_correlation(JointFit(image, kDisc, 1), 0, {}), 1);
}

}  // namespace
}  // namespace grainfield::tracking
