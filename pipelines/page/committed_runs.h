#pragma once

#include <filesystem>
#include <vector>

#include "core/results.h"

namespace grainfield::pipelines {

/// Results of long runs that are kept as tables, for the panels of the paper where the own runs
/// have nothing: one run for each folder `gamma-VALUE` (curves as `export` writes them), with S1 of
/// `fits.csv`, and S0/S1 of all from `range.csv`. They stand for the experiment: the identity is
/// that of tracked films. What a table does not hold is left out. Throws InputError for a folder
/// without such runs, or a table that cannot be read.
std::vector<Results> committed_runs(const std::filesystem::path& folder);

}  // namespace grainfield::pipelines
