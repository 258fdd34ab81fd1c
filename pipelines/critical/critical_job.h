#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/statistics/critical.h"
#include "core/results.h"
#include "pipelines/job.h"

namespace grainfield::pipelines {

/// How S0/S1 of each run is found.
enum class SharedExponent {
    no,   ///< as the results give it
    yes,  ///< all spectra fitted again with one exponent
};

/// What the search for a critical point is asked for; its inputs are those of the job.
struct CriticalJobOptions {
    std::filesystem::path output;
    std::string label = "critical point";  ///< name in plots
    std::string parameter;  ///< the control parameter; an option of the runs if `values` is empty
    std::vector<double>
        values;  ///< of the control parameter, one for each input; empty: as recorded
    analysis::CriticalLine line = analysis::CriticalLine::free;
    SharedExponent exponent = SharedExponent::no;
};

/// What was found.
struct CriticalJobResult {
    std::size_t runs = 0;  ///< that gave a point
    ObservableResult critical;
};

/// Whether a search gave neither a value nor a line: its `reason` says why.
bool has_no_value(const ObservableResult& critical);

/// Reads the results, puts a line through S0/S1 against the control parameter, and writes the
/// output. Runs without S0/S1 are left out with a warning; where the others give no value their
/// points are written, and a warning says what would help. Throws OptionError, InputError,
/// OutputError, Interrupted.
CriticalJobResult find_critical_point(const CriticalJobOptions& options, Job& job);

}  // namespace grainfield::pipelines
