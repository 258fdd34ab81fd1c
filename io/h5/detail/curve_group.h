#pragma once

#include <vector>

#include "core/results.h"
#include "io/h5/detail/h5_group.h"

namespace grainfield::io {

/// Keeps curves in an HDF5 group: one child group each with a dataset per column, and their names,
/// units and meanings as JSON in `index`, with the columns of text.
void write_curves(const H5Group& group, const std::vector<Curve>& curves);
std::vector<Curve> read_curves(const H5Group& group);

}  // namespace grainfield::io
