#pragma once

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

/// Throws Interrupted(signal, "<work> interrupted …") if a signal was caught.
void throw_if_interrupted(const char* work);

}  // namespace grainfield
