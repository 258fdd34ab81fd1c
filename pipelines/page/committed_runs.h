#pragma once

#include <filesystem>
#include <vector>

#include "core/results.h"

namespace grainfield::pipelines {

/// Results of long runs that are kept as tables, for the panels of the paper where the own runs
/// have nothing: one run for each folder `gamma-VALUE` (curves as `export` writes them), with S1 of
/// `fits.csv`, and S0/S1 of all from `range.csv`. What made them is what the column `origin` of
/// `range.csv` says, in the words of core/origin_names.h; labels name it. What a table does not
/// hold is left out. Throws InputError for a folder without such runs, a table that cannot be read,
/// and an origin that is unknown or not the same in all rows.
std::vector<Results> committed_runs(const std::filesystem::path& folder);

}  // namespace grainfield::pipelines
