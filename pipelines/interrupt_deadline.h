#pragma once

#include <functional>
#include <string>
#include <thread>
#include <type_traits>

#include "core/errors.h"

namespace grainfield::pipelines {

/// Bounds the time between SIGINT or SIGTERM and the end of the process.
///
/// While the object lives, a thread waits for a signal. If the work has not stopped by itself 1.2 s
/// after it (one enormous frame, a slow disk), the thread calls `last_act` to save what was done,
/// says what that returns, removes unfinished outputs and ends the process with 128 + signal.
class InterruptDeadline {
 public:
    /// `last_act` returns one line for standard error: "warning: …" or "error: …".
    explicit InterruptDeadline(std::function<std::string(int signal)> last_act);
    /// Does not return if the last act has begun.
    ~InterruptDeadline() = default;

 private:
    std::jthread watch_;
};

/// Ends work whose output is worth nothing until it is whole within 2 s of a signal.
class DiscardDeadline {
 public:
    /// `what`: "analysis"; `output`: the file that will not be there.
    DiscardDeadline(std::string what, std::string output);
    DiscardDeadline(const DiscardDeadline&) = delete;
    DiscardDeadline& operator=(const DiscardDeadline&) = delete;

    /// The error of work that stopped by itself, which says that the output was not written.
    Interrupted error(int signal) const;

 private:
    std::string what_;
    std::string output_;
    InterruptDeadline deadline_;
};

/// Runs work whose output is worth nothing until it is whole: a signal ends it within 2 s. Returns
/// what the work returns. Throws what the work throws; Interrupted with a message that names
/// `output`.
template <class Work>
std::invoke_result_t<Work> run_or_discard(const std::string& what, const std::string& output,
                                          Work&& work) {
    const DiscardDeadline deadline(what, output);
    try {
        return std::forward<Work>(work)();
    } catch (const Interrupted& stop) {
        throw deadline.error(stop.signal());
    }
}

}  // namespace grainfield::pipelines
