#include "pipelines/track/stored_binning.h"

#include <limits>

#include <gtest/gtest.h>

namespace grainfield::pipelines {
namespace {

TEST(StoredBinning, IsReadAsItWasDecided) {
    for (const int side : {1, 2, 32}) EXPECT_EQ(stored_binning({binning_curve(side)}), side);
}

TEST(StoredBinning, OfATrajectoryThatDoesNotSayIsEmpty) {
    EXPECT_FALSE(stored_binning({}).has_value());
    Curve other = binning_curve(2);
    other.name = "camera";
    EXPECT_FALSE(stored_binning({other}).has_value());
}

TEST(StoredBinning, ThatIsDamagedIsEmpty) {
    for (const double wrong : {std::numeric_limits<double>::quiet_NaN(), -1.0, 1e9}) {
        Curve damaged = binning_curve(2);
        damaged.columns[0].values = {wrong};
        EXPECT_FALSE(stored_binning({damaged}).has_value()) << wrong;
    }
    Curve empty = binning_curve(2);
    empty.columns[0].values.clear();
    EXPECT_FALSE(stored_binning({empty}).has_value());
}

}  // namespace
}  // namespace grainfield::pipelines
