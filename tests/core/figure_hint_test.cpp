#include "core/figure_hint.h"

#include <gtest/gtest.h>

namespace grainfield {
namespace {

TEST(Axis, HasItsUnitInBracketsIfItHasOne) {
    EXPECT_EQ((Axis{"k", "Wavevector k", "1/a"}).title(), "Wavevector k [1/a]");
    EXPECT_EQ((Axis{"s", "S(k)", ""}).title(), "S(k)");
}

}  // namespace
}  // namespace grainfield
