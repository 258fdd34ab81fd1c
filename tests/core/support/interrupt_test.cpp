#include "core/support/interrupt.h"

#include <atomic>
#include <csignal>
#include <thread>

#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield {
namespace {

// Each case runs in a child process (a death test), because signals stick to a process.

void first_signal_only_sets_the_flag() {
    catch_interrupts();
    if (caught_signal() != 0) std::exit(10);
    throw_if_interrupted("waiting");
    std::raise(SIGTERM);
    if (caught_signal() != SIGTERM) std::exit(11);
    try {
        throw_if_interrupted("tracking");
    } catch (const Interrupted& stop) {
        const std::string text = stop.what();
        std::exit(stop.signal() == SIGTERM && text == "tracking interrupted by SIGTERM." ? 0 : 12);
    }
    std::exit(13);
}

void second_signal_of_the_same_kind_ends_the_process() {
    catch_interrupts();
    std::raise(SIGINT);
    std::raise(SIGINT);
    std::exit(0);
}

TEST(StoppableJobTest, AJobIsStoppedAloneAndOnlyInItsThread) {
    std::atomic<int> stop{0};
    {
        const StoppableJob job(stop);
        EXPECT_EQ(caught_signal(), 0);
        stop = SIGINT;
        EXPECT_EQ(caught_signal(), SIGINT);
        EXPECT_THROW(throw_if_interrupted("linking"), Interrupted);
        std::thread([] { EXPECT_EQ(caught_signal(), 0); }).join();
    }
    EXPECT_EQ(caught_signal(), 0);
}

TEST(StoppableJobTest, TheInnermostJobCounts) {
    std::atomic<int> outer{SIGTERM};
    std::atomic<int> inner{0};
    const StoppableJob first(outer);
    {
        const StoppableJob second(inner);
        EXPECT_EQ(caught_signal(), 0);
    }
    EXPECT_EQ(caught_signal(), SIGTERM);
}

TEST(InterruptDeathTest, TheFirstSignalOnlySetsAFlagThatThrowsWhenAsked) {
    EXPECT_EXIT(first_signal_only_sets_the_flag(), testing::ExitedWithCode(0), "");
}

TEST(InterruptDeathTest, TheSecondSignalOfTheSameKindEndsTheProcess) {
    EXPECT_EXIT(second_signal_of_the_same_kind_ends_the_process(), testing::KilledBySignal(SIGINT),
                "");
}

}  // namespace
}  // namespace grainfield
