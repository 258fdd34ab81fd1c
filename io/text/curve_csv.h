#pragma once

#include <filesystem>

#include "core/results.h"

namespace grainfield::io {

/// Reads a curve as `export_curves` writes it: a header line with the names of the columns, then
/// numbers, empty where missing (NaN). Named after the file; units are not in it. Columns of words
/// go to `text_columns`. Throws InputError with the line if a row has another number of fields.
Curve read_curve_csv(const std::filesystem::path& path);

}  // namespace grainfield::io
