#include "tracking/calibrate/explained_share.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace grainfield::tracking {
namespace {

Image half_and_half(int side) {
    Image image(side, side);
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) image(x, y) = x % 2 == 0 ? 1.0F : 0.0F;
    }
    return image;
}

DiscProfile disc(double edge_width) {
    DiscProfile disc;
    disc.diameter = 10;
    disc.edge_width = edge_width;
    return disc;
}

// Variance 1/4. A misfit of 0.05² + 0.1² with noise 0.1: the share of the signal leaves only 0.05².
TEST(ExplainedShare, LeavesTheNoiseAside) {
    const double rms = std::sqrt(0.05 * 0.05 + 0.1 * 0.1);
    const ExplainedShare share = explained_share(half_and_half(100), {}, rms, 0.1, disc(0.1), 0);
    EXPECT_NEAR(share.all, 1 - 0.0125 / 0.25, 1e-6);
    EXPECT_NEAR(share.signal, 1 - 0.0025 / 0.24, 1e-6);
    EXPECT_NEAR(share.charged, share.signal, 1e-12);
}

// N = 100² pixels of one value each, p = 2 · 2,500 numbers: what is left counts double.
TEST(ExplainedShare, FittedNumbersPayForThemselves) {
    const ExplainedShare share = explained_share(half_and_half(100), {}, 0.1, 0, disc(0.1), 2500);
    EXPECT_NEAR(share.support, 2, 1e-12);
    EXPECT_NEAR(1 - share.charged, 2 * (1 - share.signal), 1e-9);
    EXPECT_EQ(explained_share(half_and_half(100), {}, 0.1, 0, disc(0.1), 5000).charged, 0);
}

// White noise seen through the point spread of an edge w has the correlation of a Gaussian of
// twice the variance; its integral over the plane is the area of a cell.
TEST(ExplainedShare, ACellIsTheAreaOfTheCorrelationOfTheBlur) {
    const double w = 2;
    const double s2 = std::numbers::pi * std::numbers::pi * w * w / 12;
    double sum = 0;
    constexpr double step = 0.05;
    for (double x = -20; x < 20; x += step) sum += step * std::exp(-x * x / (4 * s2));
    EXPECT_NEAR(resolution_cell(w), sum * sum, 1e-6 * sum * sum);
    EXPECT_EQ(resolution_cell(0.1), 1);
}

}  // namespace
}  // namespace grainfield::tracking
