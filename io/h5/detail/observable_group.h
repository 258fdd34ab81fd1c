#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "core/results.h"
#include "io/h5/detail/h5_group.h"

namespace grainfield::io {

/// Writes the columns of all curves as datasets <observable>/<curve>/<column> under `curves` and
/// returns the text with everything else. read_observables gives back every bit.
nlohmann::json write_observables(const H5Group& curves,
                                 const std::vector<ObservableResult>& observables);

/// Throws nlohmann::json::exception for a damaged text, InputError for damaged data or columns of
/// different lengths.
std::vector<ObservableResult> read_observables(const H5Group& curves, const nlohmann::json& text);

/// Throws OutputError naming the first curve whose columns have different lengths.
void require_rectangular(const std::vector<ObservableResult>& observables, const H5File& file);

}  // namespace grainfield::io
