// What cannot be done is refused before anything is allocated.
#include <chrono>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/program.h"

namespace grainfield {
namespace {

using ::testing::HasSubstr;
using testing::Outcome;
using testing::ScratchFolder;

class ImpossibleSize : public ::testing::TestWithParam<const char*> {};

// With 4 GB, whatever the machine has.
TEST_P(ImpossibleSize, IsRefusedAtOnceWithWhatItNeedsAndWhatThereIs) {
    const ScratchFolder folder;
    const auto start = std::chrono::steady_clock::now();
    const Outcome outcome = testing::shell("ulimit -v 4000000; $GRAINFIELD simulate " +
                                           std::string(GetParam()) + " -o " + (folder / "x.h5"));
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_THAT(outcome.err, ::testing::ContainsRegex("about [0-9.e+]+ (GB|MB) of memory and "));
    EXPECT_THAT(outcome.err, ::testing::ContainsRegex("at most [0-9.]+ (GB|MB), which are free"));
    EXPECT_THAT(outcome.err, HasSubstr("--force-size"));
    EXPECT_EQ(folder.entries(), 0U);
}

INSTANTIATE_TEST_SUITE_P(
    OfASimulation, ImpossibleSize,
    ::testing::Values("field --nx 16777216", "field --nx 4096 --ny 16384 --replicas 20",
                      "field --record 1e12 --dt 1e-6",
                      "md --grains 100000000 --length-x 12000 --length-y 12000",
                      "md --grains 10 --length-x 60000 --length-y 60000",
                      "md --grains 1000 --periods 1e9"));

TEST(InsistedOnSize, IsBegunWithAWarning) {
    const ScratchFolder folder;
    const Outcome outcome = testing::run_grainfield(
        {"simulate", "md", "--grains", "60", "--length-x", "8", "--length-y", "8", "--periods",
         "1e9", "--force-size", "--explain", "-o", folder / "a.h5"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("warning: the size is insisted on"));
}

// It gave "0 steps" and exit code 0.
TEST(NoStep, InTheTimeAskedForIsAnError) {
    const ScratchFolder folder;
    const Outcome outcome = testing::run_grainfield(
        {"simulate", "field", "--dt", "1e6", "--record", "200", "-o", folder / "f.h5"});
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("no step fits into --relax and --record"));
    EXPECT_THAT(outcome.err, HasSubstr("--dt = 1e+06"));
    EXPECT_EQ(folder.entries(), 0U);
}

}  // namespace
}  // namespace grainfield
