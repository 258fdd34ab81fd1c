#include "core/support/interrupt.h"

#include <csignal>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield {

namespace {

std::atomic<int> signal_seen{0};
static_assert(std::atomic<int>::is_always_lock_free, "used in a signal handler");

thread_local const std::atomic<int>* stop_of_job = nullptr;

extern "C" void remember_signal(int signal) {
    signal_seen.store(signal, std::memory_order_relaxed);
}

}  // namespace

void catch_interrupts() {
    struct sigaction action {};
    action.sa_handler = remember_signal;
    sigemptyset(&action.sa_mask);
    // The handler is gone after the first signal, so that the second one ends the process.
    action.sa_flags = static_cast<int>(SA_RESETHAND | static_cast<unsigned>(SA_RESTART));
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

void ignore_file_size_signal() {
    struct sigaction action {};
    action.sa_handler = SIG_IGN;
    sigemptyset(&action.sa_mask);
    sigaction(SIGXFSZ, &action, nullptr);
}

int caught_signal() {
    const int signal = signal_seen.load(std::memory_order_relaxed);
    if (signal != 0 || stop_of_job == nullptr) return signal;
    return stop_of_job->load(std::memory_order_relaxed);
}

StoppableJob::StoppableJob(const std::atomic<int>& stop) : before_(stop_of_job) {
    stop_of_job = &stop;
}

StoppableJob::~StoppableJob() {
    stop_of_job = before_;
}

void throw_if_interrupted(const char* work) {
    const int signal = caught_signal();
    if (signal == 0) return;
    throw Interrupted(signal, fmt::format("{} interrupted by {}.", work,
                                          signal == SIGINT ? "SIGINT" : "SIGTERM"));
}

}  // namespace grainfield
