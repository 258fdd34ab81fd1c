#pragma once

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>

#include <unistd.h>

#include "core/support/interrupt.h"

namespace grainfield::testing {

/// Runs a job, which returns the signal that ended it, in a process of its own (EXPECT_EXIT) and
/// sends it SIGINT once its first checkpoint stands beside the output. Exits with 130 if the job
/// was interrupted, 1 if it was done before.
template <class Work>
[[noreturn]] void interrupt_once_saved(const std::string& output, const Work& work) {
    catch_interrupts();
    const std::jthread sender([checkpoint = output + ".checkpoint"](const std::stop_token& stop) {
        while (!stop.stop_requested() && !std::filesystem::exists(checkpoint)) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        kill(getpid(), SIGINT);
    });
    std::_Exit(work() == SIGINT ? 130 : 1);
}

}  // namespace grainfield::testing
