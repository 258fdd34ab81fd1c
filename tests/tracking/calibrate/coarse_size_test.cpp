#include "tracking/calibrate/coarse_size.h"

#include <gtest/gtest.h>

#include "tests/support/layer_frames.h"

namespace grainfield::tracking {
namespace {

TEST(CoarseSize, FindsTheRadiusOfDiscsAndCoversThem) {
    for (const double diameter : {6.0, 16.0, 40.0}) {
        const auto scene = testing::hard_disc_liquid(600, 600, diameter, 0.6, 4);
        const Image frame = testing::tanh_frame(scene, diameter, 0.08 * diameter, 0.02, 1);
        Image mask(600, 600);
        Image gaps(600, 600);
        for (std::size_t i = 0; i < mask.size(); ++i) {
            mask.pixels()[i] = frame.pixels()[i] < 115 ? 1.0F : 0.0F;
            gaps.pixels()[i] = 1 - mask.pixels()[i];
        }
        const CoarseSize size = coarse_sizes(mask).at(0);
        EXPECT_NEAR(size.radius, diameter / 2, 0.08 * diameter + 0.5) << diameter;
        EXPECT_GT(size.coverage, 1.5 * coarse_sizes(gaps).at(0).coverage) << diameter;
    }
}

TEST(CoarseSize, OfAnEmptyMaskIsNothing) {
    EXPECT_TRUE(coarse_sizes(Image(20, 20)).empty());
}

}  // namespace
}  // namespace grainfield::tracking
