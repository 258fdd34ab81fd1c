#pragma once

#include <string>
#include <vector>

#include "core/results.h"
#include "io/h5/detail/h5_group.h"

namespace grainfield::io {

/// Adds a group `name` with a preview: the image in 8 bits (counts = offset + scale · pixel; exact
/// if the counts are whole numbers within 0 … 255, else off by at most (max − min)/510), gzipped;
/// the columns of the snapshot; |Q4|; what is left as JSON text `description`.
void write_preview(const H5Group& parent, const std::string& name, const Preview& preview);

/// All previews of a group, in the order of their numbers 0, 1, …
std::vector<Preview> read_previews(const H5Group& parent);

}  // namespace grainfield::io
