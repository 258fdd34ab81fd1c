#include "core/support/huge_pages.h"

#include <cstdint>
#include <numeric>

#include <gtest/gtest.h>

namespace grainfield {
namespace {

TEST(HugePages, LargeVectorsStartOnAHugePageAndSmallOnesOnACacheLine) {
    HugeVector<float> large(3 << 20, 1.5F);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(large.data()) % (1U << 21), 0u);
    EXPECT_EQ(std::accumulate(large.begin(), large.end(), 0.0), 1.5 * (3 << 20));
    const HugeVector<char> small(10);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(small.data()) % 64, 0u);
}

TEST(HugePages, VectorsGrowAndMoveAsUsual) {
    HugeVector<int> values;
    for (int i = 0; i < 2'000'000; ++i) values.push_back(i);
    const HugeVector<int> moved = std::move(values);
    EXPECT_EQ(moved[1'999'999], 1'999'999);
}

}  // namespace
}  // namespace grainfield
