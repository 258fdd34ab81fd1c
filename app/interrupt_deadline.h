#pragma once

#include <functional>
#include <string>
#include <thread>

#include "app/command.h"

namespace grainfield::app {

/// Bounds the time between SIGINT or SIGTERM and the end of the process.
///
/// While the object lives, a thread waits for a signal. If the work has not stopped by itself 1.2 s
/// after it (one enormous frame, a slow disk), the thread calls `last_act` to save and to say what
/// was done, removes unfinished outputs and ends the process with 128 + signal.
class InterruptDeadline {
 public:
    explicit InterruptDeadline(std::function<void(int signal)> last_act);
    /// Does not return if the last act has begun.
    ~InterruptDeadline() = default;

 private:
    std::jthread watch_;
};

/// Runs work whose output is worth nothing until it is whole: a signal ends it within 2 s, and the
/// message says that `output` was not written. Throws what the work throws; Interrupted with that
/// message.
Summary run_or_discard(const std::string& what, const std::string& output,
                       const std::function<Summary()>& work);

}  // namespace grainfield::app
