#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

#include <H5Dpublic.h>
#include <H5Fpublic.h>
#include <H5Ppublic.h>
#include <H5Spublic.h>

namespace grainfield::io {

/// Leaves the first `frames` rows of one column of a trajectory, as a killed writer does that had
/// not come to it. `column` is its path, e.g. "/particles/trajectory/id/value".
inline void cut_column(const std::filesystem::path& path, const std::string& column,
                       hsize_t frames) {
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    const hid_t data = H5Dopen2(file, column.c_str(), H5P_DEFAULT);
    const hid_t space = H5Dget_space(data);
    hsize_t extent[8] = {};
    const bool is_known = H5Sget_simple_extent_dims(space, extent, nullptr) > 0;
    extent[0] = frames;
    const bool is_cut = is_known && H5Dset_extent(data, extent) >= 0;
    H5Sclose(space);
    H5Dclose(data);
    H5Fclose(file);
    if (!is_cut) throw std::runtime_error("cannot cut " + column);
}

}  // namespace grainfield::io
