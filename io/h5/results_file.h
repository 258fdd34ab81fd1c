#pragma once

#include <filesystem>

#include "core/results.h"
#include "core/support/output_file.h"

namespace grainfield::io {

/// Writes results as HDF5: the columns of each curve as datasets
/// /results/curves/<observable>/<curve>/<column>, previews under /results/previews, everything else
/// as JSON text /results/description and /results/record. Reading gives back every bit, except
/// that preview images are kept with 8 bits a pixel.
/// Throws OutputError (see OutputFile), also for columns of unequal length.
void write_results(const std::filesystem::path& path, const Results& results, Overwrite overwrite);

/// The same into an output that was claimed before the work began.
void write_results(OutputFile output, const Results& results);

/// Throws InputError if the file is missing, damaged or not a results file.
Results read_results(const std::filesystem::path& path);

}  // namespace grainfield::io
