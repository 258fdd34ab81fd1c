#include <cstdio>

#include <unistd.h>

#include "app/command_line.h"
#include "app/exit_code.h"
#include "core/interrupt.h"

int main(int argc, char** argv) {
    grainfield::catch_interrupts();
    const int code = grainfield::app::run_command_line(argc, argv);
    if (code == static_cast<int>(grainfield::app::ExitCode::output_failed)) {
        // After a full disk HDF5 crashes while it cleans up at exit; all that matters is done.
        std::fflush(nullptr);
        _exit(code);
    }
    return code;
}
