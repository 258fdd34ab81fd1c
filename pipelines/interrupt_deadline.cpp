#include "pipelines/interrupt_deadline.h"

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <exception>
#include <mutex>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "core/support/interrupt.h"
#include "core/support/output_file.h"
#include "core/support/printable.h"

namespace grainfield::pipelines {

namespace {

using namespace std::chrono_literals;

// False if asked to stop before the time is over.
bool sleep(const std::stop_token& stop, std::chrono::milliseconds time) {
    std::mutex mutex;
    std::condition_variable_any never;
    std::unique_lock lock(mutex);
    never.wait_for(lock, stop, time, [] { return false; });
    return !stop.stop_requested();
}

std::string discarded(const std::string& what, int signal, const std::string& output) {
    return fmt::format("{} interrupted by {}; '{}' was not written.", what,
                       signal == SIGINT ? "SIGINT" : "SIGTERM", output);
}

// What the last act says; an exception would end the program without a word, as no one catches it
// in this thread.
std::string said_by(const std::function<std::string(int signal)>& act, int signal) {
    try {
        return act(signal);
    } catch (const std::exception& error) {
        return fmt::format("error: {}", error.what());
    }
}

}  // namespace

InterruptDeadline::InterruptDeadline(std::function<std::string(int signal)> last_act)
    : watch_([act = std::move(last_act)](const std::stop_token& stop) {
          while (caught_signal() == 0) {
              if (!sleep(stop, 50ms)) return;
          }
          if (!sleep(stop, 1200ms)) return;
          fmt::print(stderr, "{}\n", printable(said_by(act, caught_signal())));
          static_cast<void>(abandon_outputs());
          std::fflush(nullptr);
          _exit(128 + caught_signal());
      }) {}

DiscardDeadline::DiscardDeadline(std::string what, std::string output)
    : what_(std::move(what)), output_(std::move(output)), deadline_([this](int signal) {
          // Nothing may be completed any more while this is said.
          static_cast<void>(abandon_outputs());
          return "error: " + discarded(what_, signal, output_);
      }) {}

Interrupted DiscardDeadline::error(int signal) const {
    return Interrupted(signal, discarded(what_, signal, output_));
}

}  // namespace grainfield::pipelines
