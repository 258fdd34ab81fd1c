#pragma once

#include <atomic>

namespace grainfield {

/// Catches SIGINT and SIGTERM from now on: the first one only sets a flag, the second one of the
/// same kind ends the process at once. Called once, by `main`.
void catch_interrupts();

/// Turns SIGXFSZ, which ends a process whose file may not grow further (`ulimit -f`), into a failed
/// write (EFBIG) that is reported like a full disk.
void ignore_file_size_signal();

/// The signal that was caught, 0 if none. Long loops ask this between units of work, finish their
/// output and throw `Interrupted`. Safe from any thread.
int caught_signal();

/// One job among others of a process may be stopped alone: while this lives, caught_signal() in the
/// thread that made it also says what `stop` holds. For programs that catch signals themselves and
/// call the libraries, such as Python. Scopes of a thread nest; the innermost counts.
class StoppableJob {
 public:
    explicit StoppableJob(const std::atomic<int>& stop);  ///< must outlive this; 0: go on
    ~StoppableJob();
    StoppableJob(const StoppableJob&) = delete;
    StoppableJob& operator=(const StoppableJob&) = delete;

 private:
    const std::atomic<int>* before_;
};

/// Throws Interrupted(signal, "<work> interrupted …") if a signal was caught.
void throw_if_interrupted(const char* work);

}  // namespace grainfield
