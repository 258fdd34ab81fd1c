#include <cstdio>

#if defined(__GLIBC__)
#include <malloc.h>
#endif
#include <unistd.h>

#include "app/command_line.h"
#include "app/exit_code.h"
#include "core/support/interrupt.h"

namespace {

/// Frames come and go by the ten megabytes. Given back to the system each time, their memory would
/// be cleared by it each time.
void keep_freed_memory() {
#if defined(__GLIBC__)
    mallopt(M_MMAP_THRESHOLD, 1 << 25);  // [byte], the most that is accepted
    mallopt(M_TRIM_THRESHOLD, 1 << 28);
#endif
}

}  // namespace

int main(int argc, char** argv) {
    keep_freed_memory();
    grainfield::catch_interrupts();
    grainfield::ignore_file_size_signal();
    const int code = grainfield::app::run_command_line(argc, argv);
    if (code == static_cast<int>(grainfield::app::ExitCode::output_failed)) {
        // After a full disk HDF5 crashes while it cleans up at exit; all that matters is done.
        std::fflush(nullptr);
        _exit(code);
    }
    return code;
}
