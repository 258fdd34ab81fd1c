#include "app/interrupt_deadline.h"

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "core/support/output_file.h"

namespace grainfield::app {

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

}  // namespace

InterruptDeadline::InterruptDeadline(std::function<void(int signal)> last_act)
    : watch_([act = std::move(last_act)](const std::stop_token& stop) {
          while (caught_signal() == 0) {
              if (!sleep(stop, 50ms)) return;
          }
          if (!sleep(stop, 1200ms)) return;
          act(caught_signal());
          static_cast<void>(abandon_outputs());
          std::fflush(nullptr);
          _exit(128 + caught_signal());
      }) {}

Summary run_or_discard(const std::string& what, const std::string& output,
                       const std::function<Summary()>& work) {
    const InterruptDeadline deadline([&](int signal) {
        // Nothing may be completed any more while this is said.
        static_cast<void>(abandon_outputs());
        fmt::print(stderr, "error: {}\n", discarded(what, signal, output));
    });
    try {
        return work();
    } catch (const Interrupted& stop) {
        throw Interrupted(stop.signal(), discarded(what, stop.signal(), output));
    }
}

}  // namespace grainfield::app
