#include "core/figure_hint.h"

#include <gtest/gtest.h>

namespace grainfield {
namespace {

TEST(Axis, HasItsUnitInBracketsIfItHasOne) {
    EXPECT_EQ((Axis{"k", "Wavevector k", "1/a"}).title(), "Wavevector k [1/a]");
    EXPECT_EQ((Axis{"s", "S(k)", ""}).title(), "S(k)");
}

TEST(Axis, NamesTheUnitsOfAllRunsThatShareIt) {
    Axis k{"k", "Wavevector k", "1/a"};
    k.units = {run_unit("1/a", TimeUnit::second), run_unit("1/l", TimeUnit::frame)};
    EXPECT_EQ(k.title(), "Wavevector k [1/a or 1/l]");
    Axis t{"t", "Lag time", "time unit"};
    EXPECT_EQ(t.title(), "Lag time [time unit]");
    t.units = {run_unit("time unit", TimeUnit::second)};
    EXPECT_EQ(t.title(), "Lag time [s]");
    EXPECT_EQ((Axis{"y", "MSD", "a^2"}).title(), "MSD [a²]");
}

TEST(Axis, RunsDifferInATimeUnitOnlyWhereTheUnitHasTimeInIt) {
    EXPECT_EQ(run_unit("a", TimeUnit::second), run_unit("a", TimeUnit::frame));
    EXPECT_NE(run_unit("a^2/time unit", TimeUnit::second),
              run_unit("a^2/time unit", TimeUnit::frame));
}

}  // namespace
}  // namespace grainfield
