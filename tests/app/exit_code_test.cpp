#include "app/exit_code.h"

#include <csignal>
#include <new>
#include <stdexcept>

#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield::app {
namespace {

TEST(ExitCode, TellsTheCauseOfEveryKindOfFailure) {
    EXPECT_EQ(exit_code(OptionError("x")), 2);
    EXPECT_EQ(exit_code(InputError("x")), 3);
    EXPECT_EQ(exit_code(OutputError("x")), 4);
    EXPECT_EQ(exit_code(PhysicsError("x")), 5);
    EXPECT_EQ(exit_code(Error("x")), 1);
    EXPECT_EQ(exit_code(std::runtime_error("x")), 1);
    EXPECT_EQ(exit_code(std::bad_alloc()), 1);
}

TEST(ExitCode, OfAnInterruptIs128PlusTheSignal) {
    EXPECT_EQ(exit_code(Interrupted(SIGINT, "x")), 130);
    EXPECT_EQ(exit_code(Interrupted(SIGTERM, "x")), 143);
    EXPECT_EQ(exit_code(SIGTERM), 143);
}

}  // namespace
}  // namespace grainfield::app
