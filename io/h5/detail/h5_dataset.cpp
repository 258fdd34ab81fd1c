#include "io/h5/detail/h5_dataset.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "io/h5/detail/h5_storage.h"

namespace grainfield::io {

template <>
hid_t h5_type<double>() {
    return H5T_NATIVE_DOUBLE;
}
template <>
hid_t h5_type<std::int64_t>() {
    return H5T_NATIVE_INT64;
}
template <>
hid_t h5_type<std::int8_t>() {
    return H5T_NATIVE_INT8;
}
template <>
hid_t h5_type<std::uint8_t>() {
    return H5T_NATIVE_UINT8;
}

namespace {

double product(const H5Extent& extent) {
    return std::accumulate(extent.begin(), extent.end(), 1.0,
                           [](double p, hsize_t n) { return p * static_cast<double>(n); });
}

H5Extent row_count(const H5Extent& extent, hsize_t columns) {
    H5Extent count = extent;
    count.at(0) = 1;
    if (count.size() > 1) count[1] = columns;
    return count;
}

}  // namespace

H5Extent H5Dataset::extent() const {
    const H5Handle space = file().own(H5Dget_space(id()), "a dataset has no extent");
    const int rank = H5Sget_simple_extent_ndims(space.get());
    if (rank < 0) file().fail(fmt::format("the extent of {} is damaged", path()));
    H5Extent extent(static_cast<std::size_t>(rank));
    if (rank > 0) {
        file().require(H5Sget_simple_extent_dims(space.get(), extent.data(), nullptr),
                       "the extent of a dataset is damaged");
    }
    return extent;
}

std::string H5Dataset::extent_text() const {
    std::string text;
    for (const hsize_t length : extent()) {
        if (!text.empty()) text += ", ";
        text += std::to_string(length);
    }
    return "[" + text + "]";
}

NumberKind H5Dataset::kind() const {
    const H5Handle type = file().own(H5Dget_type(id()), "a dataset has no type");
    const H5T_class_t kind = H5Tget_class(type.get());
    if (kind == H5T_INTEGER) return NumberKind::integer;
    return kind == H5T_FLOAT ? NumberKind::real : NumberKind::none;
}

void H5Dataset::require_number() const {
    if (kind() != NumberKind::none) return;
    file().fail(fmt::format("{} is not an array of numbers", path()));
}

template <class T>
std::vector<T> H5Dataset::read() const {
    require_number();
    const double entries = product(extent());
    file().require_plausible(entries * sizeof(T), path());
    std::vector<T> values(static_cast<std::size_t>(entries));
    if (values.empty()) return values;
    require_sound_storage(file(), id(), path(), H5Extent(extent().size(), 0), extent());
    if (H5Dread(id(), h5_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
        file().fail(fmt::format("{} is damaged", path()));
    }
    return values;
}

H5Handle H5Dataset::select(hsize_t row, const H5Extent& count) const {
    H5Handle space = file().own(H5Dget_space(id()), "a dataset has no extent");
    H5Extent start(count.size(), 0);
    start[0] = row;
    file().require(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr,
                                       count.data(), nullptr),
                   "a part of a dataset cannot be selected");
    return space;
}

template <class T>
std::vector<T> H5Dataset::read_row(hsize_t row) const {
    require_number();
    const H5Extent whole = extent();
    if (whole.empty() || row >= whole[0]) {
        file().fail(fmt::format("{} has no entry {}", path(), row));
    }
    const H5Extent count = row_count(whole, whole.size() > 1 ? whole[1] : 1);
    const double entries = product(count);
    file().require_plausible(entries * sizeof(T), path());
    std::vector<T> values(static_cast<std::size_t>(entries));
    if (values.empty()) return values;
    H5Extent start(count.size(), 0);
    start[0] = row;
    require_sound_storage(file(), id(), path(), start, count);
    const H5Handle file_space = select(row, count);
    const H5Handle memory = h5_space(file(), count);
    if (H5Dread(id(), h5_type<T>(), memory.get(), file_space.get(), H5P_DEFAULT, values.data()) <
        0) {
        file().fail(fmt::format("{} is damaged at entry {}", path(), row));
    }
    return values;
}

void H5Dataset::extend(hsize_t rows, hsize_t columns) const {
    H5Extent wanted = extent();
    wanted.at(0) = rows;
    if (wanted.size() > 1) wanted[1] = std::max(wanted[1], columns);
    file().require(H5Dset_extent(id(), wanted.data()), "an array cannot be extended");
}

template <class T>
void H5Dataset::write_row(hsize_t row, hsize_t columns, std::span<const T> values) const {
    if (values.empty()) return;
    const H5Extent count = row_count(extent(), columns);
    if (product(count) != static_cast<double>(values.size())) {
        file().fail(fmt::format("{} values for {} of {}", values.size(), columns, path()));
    }
    const H5Handle file_space = select(row, count);
    const H5Handle memory = h5_space(file(), count);
    file().require(
        H5Dwrite(id(), h5_type<T>(), memory.get(), file_space.get(), H5P_DEFAULT, values.data()),
        "data cannot be written");
}

template std::vector<double> H5Dataset::read() const;
template std::vector<std::int64_t> H5Dataset::read() const;
template std::vector<std::int8_t> H5Dataset::read() const;
template std::vector<std::uint8_t> H5Dataset::read() const;
template std::vector<double> H5Dataset::read_row(hsize_t) const;
template std::vector<std::int64_t> H5Dataset::read_row(hsize_t) const;
template std::vector<std::int8_t> H5Dataset::read_row(hsize_t) const;
template void H5Dataset::write_row(hsize_t, hsize_t, std::span<const double>) const;
template void H5Dataset::write_row(hsize_t, hsize_t, std::span<const std::int64_t>) const;
template void H5Dataset::write_row(hsize_t, hsize_t, std::span<const std::int8_t>) const;
template void H5Dataset::write_row(hsize_t, hsize_t, std::span<const std::uint8_t>) const;

}  // namespace grainfield::io
