#pragma once

#include <string>

#include "io/h5/detail/h5_object.h"

namespace grainfield::io {

/// Fails unless what a file stores for the part [start, start + count) of a dataset is as long as
/// its extent, type and chunks say. HDF5 1.10 believes these lengths, which stand in different
/// places of a file, and reads beyond its buffers when they disagree; so ask before any H5Dread.
///
/// Chunks that are stored as they are, or with shuffle and Fletcher-32, are compared by length
/// (where no filter is used and there are more than 4096 of them, only the sum of their lengths
/// is); deflated ones are inflated once for this. Other filters are refused. Costs one more reading
/// of the chunks concerned.
void require_sound_storage(const H5File& file, hid_t dataset, const std::string& path,
                           const H5Extent& start, const H5Extent& count);

}  // namespace grainfield::io
