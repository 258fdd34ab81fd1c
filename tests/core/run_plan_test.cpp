#include "core/run_plan.h"

#include <gtest/gtest.h>

namespace grainfield {
namespace {

TEST(RunPlan, ListsStagesInOrderWithReasonAndSaving) {
    RunPlan plan;
    plan.run("detection", "dark discs of 8.9 px");
    plan.skip("background fit", "illumination uniform to 0.3 %", "12 ms a frame");
    plan.skip("linking", "one frame", "");
    EXPECT_EQ(plan.text(),
              "run  detection: dark discs of 8.9 px\n"
              "skip background fit: illumination uniform to 0.3 % (saves 12 ms a frame)\n"
              "skip linking: one frame\n");
    ASSERT_EQ(plan.skipped().size(), 2U);
    EXPECT_EQ(plan.skipped()[0].stage, "background fit");
    EXPECT_EQ(plan.stages().size(), 3U);
}

TEST(RunPlan, KeepsEachWarningOnceInOrderOfFirstAppearance) {
    RunPlan plan;
    plan.warn("b");
    plan.warn("a");
    plan.warn("b");
    EXPECT_EQ(plan.warnings(), (std::vector<Warning>{{.text = "b"}, {.text = "a"}}));
}

TEST(RunPlan, TakesOverAnotherOneInItsOwnWords) {
    RunPlan attempt;
    attempt.run("start", "with option 'resume'");
    attempt.skip("log", "not asked for", "1 ms");
    attempt.warn(WarningCode::apparent_diameter, "a");
    RunPlan plan([](std::string text) {
        const auto at = text.find("option 'resume'");
        return at == std::string::npos ? text : text.replace(at, 15, "--resume");
    });
    plan.warn("b");
    plan.take(attempt);
    EXPECT_EQ(plan.text(), "run  start: with --resume\nskip log: not asked for (saves 1 ms)\n");
    ASSERT_EQ(plan.warnings().size(), 2U);
    EXPECT_EQ(plan.warnings()[1].code, WarningCode::apparent_diameter);
}

TEST(RunPlan, SaysEverythingInTheWordsOfTheCaller) {
    RunPlan plan([](std::string text) {
        const auto at = text.find("option 'resume'");
        return at == std::string::npos ? text : text.replace(at, 15, "--resume");
    });
    plan.warn("option 'resume' goes on");
    plan.warn("--resume goes on");
    plan.run("start", "with option 'resume'");
    plan.skip("log", "without option 'resume'", "");
    EXPECT_EQ(plan.warnings(), (std::vector<Warning>{{.text = "--resume goes on"}}));
    EXPECT_EQ(plan.text(), "run  start: with --resume\nskip log: without --resume\n");
}

TEST(RunPlan, KeepsTheCodeThatAWarningCameWithFirst) {
    RunPlan plan;
    plan.warn(WarningCode::incomplete, "a");
    plan.warn("a");
    plan.warn(Warning{WarningCode::apparent_diameter, "b"});
    EXPECT_EQ(plan.warnings(), (std::vector<Warning>{{WarningCode::incomplete, "a"},
                                                     {WarningCode::apparent_diameter, "b"}}));
}

}  // namespace
}  // namespace grainfield
