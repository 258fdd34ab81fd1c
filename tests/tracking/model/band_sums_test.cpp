#include "tracking/model/band_sums.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/layer_frames.h"
#include "tracking/model/disc_profile.h"
#include "tracking/model/profile_shape.h"

namespace grainfield::tracking {
namespace {

/// P = erfc((r − D/2)/w)/2: has no closed form in the kernels, so that it is read from tables.
class GaussianEdge final : public ProfileShape {
 public:
    std::string_view name() const override { return "gaussian"; }
    double darkness(double r, double diameter, double edge_width) const override {
        return 0.5 * std::erfc((r - diameter / 2) / edge_width);
    }
    double reach_in_widths() const override { return 2.2; }
};
const GaussianEdge kGaussian;

struct Sums {
    double transmission = 1, along_x = 0, along_y = 0, squares = 0;
};

/// In double precision, pixel by pixel.
Sums plain_sums(const std::vector<Vec2>& discs, const DiscProfile& disc, int x, int y) {
    Sums sums;
    for (const Vec2 p : discs) {
        const Vec2 d{x - p.x, y - p.y};
        const double r = norm(d);
        if (r >= disc.reach()) continue;
        const double dark = disc.darkness(r);
        sums.transmission *= 1 - dark;
        sums.along_x += dark * d.x / r;
        sums.along_y += dark * d.y / r;
        sums.squares += dark * dark;
    }
    return sums;
}

class BandSumsOf : public ::testing::TestWithParam<DiscProfile> {};

TEST_P(BandSumsOf, AgreeWithPlainSumsInEveryPixelOfTheBand) {
    const DiscProfile disc = GetParam();
    std::vector<Vec2> discs = testing::hard_disc_liquid(120, 90, 13, 0.7, 4).position;
    // Cut by each border, and one below another.
    discs.insert(discs.end(), {{-0.4, 31.2}, {119.3, 44.7}, {60.1, -0.3}, {40.2, 89.4}, {41, 87}});
    // In the middle of a disc the direction is not defined.
    for (Vec2& p : discs) p += Vec2{0.23, 0.41};
    BandSums sums;
    sums.assign(50, 0, 3, discs, KernelProfile(disc));  // memory of another band leaves no trace
    sums.assign(120, 21, 76, discs, KernelProfile(disc));
    // Transmissions are held above 9.1e-4; tables are good to 2e-5 a disc.
    for (int y = 21; y < 76; ++y) {
        for (int x = 0; x < 120; ++x) {
            const Sums expected = plain_sums(discs, disc, x, y);
            ASSERT_NEAR(sums.transmission(y)[x], expected.transmission, 1e-3) << x << ' ' << y;
            ASSERT_NEAR(sums.along_x(y)[x], expected.along_x, 2e-3) << x << ' ' << y;
            ASSERT_NEAR(sums.along_y(y)[x], expected.along_y, 2e-3) << x << ' ' << y;
            ASSERT_NEAR(sums.squares(y)[x], expected.squares, 4e-3) << x << ' ' << y;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(TanhAndTable, BandSumsOf,
                         ::testing::Values(DiscProfile{12.3, 1.3}, DiscProfile{5.1, 0.9},
                                           DiscProfile{12.3, 1.7, &kGaussian}));

TEST(BandSums, ADiscThatIsNowhereAddsNothing) {
    BandSums sums;
    const DiscProfile disc{12, 1.2};
    sums.assign(40, 0, 30, {{std::nan(""), 10}, {-400, 10}, {900, 10}, {20, 400}},
                KernelProfile(disc));
    for (int y = 0; y < 30; ++y) {
        for (int x = 0; x < 40; ++x) {
            ASSERT_EQ(sums.transmission(y)[x], 1.0F);
            ASSERT_EQ(sums.squares(y)[x], 0.0F);
        }
    }
}

}  // namespace
}  // namespace grainfield::tracking
