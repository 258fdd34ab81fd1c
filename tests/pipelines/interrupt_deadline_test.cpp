#include "pipelines/interrupt_deadline.h"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/support/interrupt.h"

namespace grainfield::pipelines {
namespace {

using namespace std::chrono_literals;
using ::testing::ExitedWithCode;
using ::testing::HasSubstr;

TEST(InterruptDeadline, EndsWorkThatIsStuckWithWhatTheLastActSays) {
    EXPECT_EXIT(
        {
            catch_interrupts();
            const InterruptDeadline deadline([](int signal) {
                return signal == SIGTERM ? "warning: two frames are kept" : "wrong signal";
            });
            std::raise(SIGTERM);
            std::this_thread::sleep_for(30s);
            std::_Exit(1);
        },
        ExitedWithCode(128 + SIGTERM), "^warning: two frames are kept\n$");
}

TEST(InterruptDeadline, SaysWhatTheLastActFailsOf) {
    EXPECT_EXIT(
        {
            catch_interrupts();
            const InterruptDeadline deadline(
                [](int) -> std::string { throw OutputError("the disk is full."); });
            std::raise(SIGINT);
            std::this_thread::sleep_for(30s);
            std::_Exit(1);
        },
        ExitedWithCode(130), "^error: the disk is full.\n$");
}

TEST(InterruptDeadline, LeavesWorkThatStopsByItselfAlone) {
    EXPECT_EXIT(
        {
            catch_interrupts();
            {
                const InterruptDeadline deadline([](int) { return "warning: too late"; });
                std::raise(SIGINT);
                std::this_thread::sleep_for(200ms);
            }
            std::this_thread::sleep_for(1500ms);
            std::_Exit(7);
        },
        ExitedWithCode(7), "^$");
}

TEST(DiscardDeadline, EndsWorkThatIsStuckAndNamesTheOutputThatIsNotThere) {
    EXPECT_EXIT(
        {
            catch_interrupts();
            const DiscardDeadline deadline("analysis", "out.h5");
            std::raise(SIGINT);
            std::this_thread::sleep_for(30s);
            std::_Exit(1);
        },
        ExitedWithCode(130), "error: analysis interrupted by SIGINT; 'out.h5' was not written");
}

TEST(RunOrDiscard, PassesOnWhatTheWorkReturnsAndThrows) {
    EXPECT_EQ(run_or_discard("analysis", "out.h5", [] { return 42; }), 42);
    EXPECT_THROW(run_or_discard("analysis", "out.h5", []() -> int { throw InputError("bad"); }),
                 InputError);
}

TEST(RunOrDiscard, SaysWhatAnInterruptedWorkDidNotWrite) {
    try {
        run_or_discard("analysis", "out.h5", [] { throw Interrupted(SIGTERM, "in a loop"); });
        FAIL() << "not thrown";
    } catch (const Interrupted& stop) {
        EXPECT_EQ(stop.signal(), SIGTERM);
        EXPECT_THAT(stop.what(), HasSubstr("analysis interrupted by SIGTERM; 'out.h5' was not"));
    }
}

}  // namespace
}  // namespace grainfield::pipelines
