#pragma once

#include <cstdint>
#include <string>

#include "core/option_table.h"
#include "core/support/progress.h"

namespace grainfield::app {

/// What every command understands, besides `-c file.toml`.
struct CommonOptions {
    int threads = 0;          ///< 0: as many as the machine has
    std::int64_t seed = 1;    ///< of all random streams
    bool explain = false;     ///< print the plan and stop
    bool json = false;        ///< summary as one JSON object on standard output
    bool quiet = false;       ///< no summary, no progress
    bool verbose = false;     ///< summary with the stages that ran
    bool force = false;       ///< replace outputs that exist
    bool force_size = false;  ///< begin what is too large for the machine

    Verbosity verbosity() const {
        if (quiet) return Verbosity::quiet;
        return verbose ? Verbosity::verbose : Verbosity::normal;
    }
};

/// In the empty section: command-wide.
OptionTable describe(CommonOptions& options);

}  // namespace grainfield::app
