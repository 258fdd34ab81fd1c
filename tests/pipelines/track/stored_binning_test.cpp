#include "pipelines/track/stored_binning.h"

#include <limits>

#include <gtest/gtest.h>

namespace grainfield::pipelines {
namespace {

const FittedBlocks kBlocks{2, "as given"};

TEST(StoredBinning, IsReadAsItWasDecided) {
    for (const FittedBlocks& blocks : {kBlocks, FittedBlocks{1, "bright spheres"}}) {
        EXPECT_EQ(stored_binning({curve_of(blocks)}), blocks);
    }
}

TEST(StoredBinning, OfATrajectoryThatDoesNotSayIsEmpty) {
    EXPECT_FALSE(stored_binning({}).has_value());
    Curve other = curve_of(kBlocks);
    other.name = "camera";
    EXPECT_FALSE(stored_binning({other}).has_value());
}

TEST(StoredBinning, ThatIsDamagedIsEmpty) {
    Curve without_words = curve_of(kBlocks);
    without_words.text_columns.clear();
    EXPECT_FALSE(stored_binning({without_words}).has_value());
    for (const double wrong : {std::numeric_limits<double>::quiet_NaN(), -1.0, 1e9}) {
        Curve damaged = curve_of(kBlocks);
        damaged.columns[0].values = {wrong};
        EXPECT_FALSE(stored_binning({damaged}).has_value()) << wrong;
    }
    Curve empty = curve_of(kBlocks);
    empty.columns[0].values.clear();
    EXPECT_FALSE(stored_binning({empty}).has_value());
}

}  // namespace
}  // namespace grainfield::pipelines
