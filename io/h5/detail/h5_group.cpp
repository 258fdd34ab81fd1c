#include "io/h5/detail/h5_group.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "io/h5/detail/h5_storage.h"

namespace grainfield::io {

namespace {

constexpr unsigned gzip_level = 1;
constexpr double longest_chunk = 4e9;  // HDF5 allows 4 GiB; longer arrays are cut

// Without the times at which HDF5 wrote each object: equal content gives equal bytes.
H5Handle creation_properties(const H5File& file, hid_t kind) {
    H5Handle properties = file.own(H5Pcreate(kind), "no property list");
    file.require(H5Pset_obj_track_times(properties.get(), false), "no property list");
    return properties;
}

// Contiguous where there is nothing to hold; otherwise one chunk with a checksum.
H5Handle array_properties(const H5File& file, const H5Extent& extent, std::size_t entry_bytes,
                          Compression compression) {
    H5Handle properties = creation_properties(file, H5P_DATASET_CREATE);
    if (std::ranges::find(extent, hsize_t{0}) != extent.end()) return properties;
    H5Extent chunk = extent;
    const double bytes =
        std::accumulate(chunk.begin(), chunk.end(), static_cast<double>(entry_bytes),
                        [](double p, hsize_t n) { return p * static_cast<double>(n); });
    if (bytes > longest_chunk) {
        const auto parts = static_cast<hsize_t>(bytes / longest_chunk) + 1;
        chunk[0] = std::max<hsize_t>(chunk[0] / parts, 1);
    }
    file.require(H5Pset_chunk(properties.get(), static_cast<int>(chunk.size()), chunk.data()),
                 "no property list");
    if (compression == Compression::gzip) {
        file.require(H5Pset_shuffle(properties.get()), "no property list");
        file.require(H5Pset_deflate(properties.get(), gzip_level), "no property list");
    }
    file.require(H5Pset_fletcher32(properties.get()), "no property list");
    return properties;
}

herr_t collect_name(hid_t, const char* name, const H5L_info_t*, void* names) noexcept {
    static_cast<std::vector<std::string>*>(names)->emplace_back(name);
    return 0;
}

}  // namespace

H5Group H5Group::root(const H5File& file) {
    return {file, file.own(H5Gopen2(file.id(), "/", H5P_DEFAULT), "the file has no root"), ""};
}

bool H5Group::has(const std::string& name) const {
    return H5Lexists(id(), name.c_str(), H5P_DEFAULT) > 0;
}

bool H5Group::has_group(const std::string& name) const {
    if (!has(name)) return false;
    H5O_info_t info;
    return H5Oget_info_by_name2(id(), name.c_str(), &info, H5O_INFO_BASIC, H5P_DEFAULT) >= 0 &&
           info.type == H5O_TYPE_GROUP;
}

std::vector<std::string> H5Group::names() const {
    std::vector<std::string> names;
    // In the order of the file: to sort, version 1.10 makes a table, and where the list of a large
    // group is damaged it frees entries that it has not filled.
    file().require(H5Literate(id(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, collect_name, &names),
                   "the list of a group is damaged");
    std::ranges::sort(names);
    return names;
}

void H5Group::refuse_foreign_link(const std::string& name) const {
    if (!has(name)) file().fail(fmt::format("there is no {}", child(name)));
    H5L_info_t info;
    file().require(H5Lget_info(id(), name.c_str(), &info, H5P_DEFAULT), "a link is damaged");
    if (info.type == H5L_TYPE_HARD || info.type == H5L_TYPE_SOFT) return;
    file().fail(fmt::format("{} is a link to another file", child(name)),
                "a file that holds its data");
}

H5Group H5Group::group(const std::string& name) const {
    refuse_foreign_link(name);
    H5Handle handle(H5Gopen2(id(), name.c_str(), H5P_DEFAULT));
    if (!handle) file().fail(fmt::format("{} is not a group", child(name)));
    return {file(), std::move(handle), child(name)};
}

H5Dataset H5Group::dataset(const std::string& name) const {
    refuse_foreign_link(name);
    H5Handle handle(H5Dopen2(id(), name.c_str(), H5P_DEFAULT));
    if (!handle) file().fail(fmt::format("{} is not a dataset", child(name)));
    const H5Handle properties =
        file().own(H5Dget_create_plist(handle.get()), "a dataset has no properties");
    if (H5Pget_layout(properties.get()) == H5D_VIRTUAL ||
        H5Pget_external_count(properties.get()) != 0) {
        file().fail(fmt::format("{} keeps its data in another file", child(name)),
                    "a file that holds its data");
    }
    return {file(), std::move(handle), child(name)};
}

std::string H5Group::text(const std::string& name) const {
    const std::string damaged = fmt::format("{} is not a text", child(name));
    const H5Dataset checked = dataset(name);
    const H5Handle data(H5Dopen2(id(), name.c_str(), H5P_DEFAULT));
    if (!data || checked.extent() != H5Extent{1}) file().fail(damaged);
    const H5Handle type = file().own(H5Dget_type(data.get()), "a text has no type");
    if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0) {
        file().fail(damaged);
    }
    const std::size_t bytes = H5Tget_size(type.get());
    file().require_plausible(static_cast<double>(bytes), child(name));
    std::vector<char> text(bytes);
    require_sound_storage(file(), data.get(), child(name), {0}, {1});
    if (H5Dread(data.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) < 0) {
        file().fail(fmt::format("{} is damaged", child(name)));
    }
    return unpadded(text.data(), text.size());
}

H5Group H5Group::make_group(const std::string& name) const {
    const H5Handle properties = creation_properties(file(), H5P_GROUP_CREATE);
    return {file(),
            file().own(H5Gcreate2(id(), name.c_str(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
                       "a group cannot be made"),
            child(name)};
}

template <class T>
H5Dataset H5Group::make_series(const std::string& name, const H5Extent& row, const H5Extent& chunk,
                               T fill) const {
    H5Extent extent{0};
    H5Extent most{H5S_UNLIMITED};
    for (std::size_t axis = 0; axis < row.size(); ++axis) {
        extent.push_back(row[axis]);
        most.push_back(axis == 0 ? H5S_UNLIMITED : row[axis]);
    }
    const H5Handle space =
        file().own(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), most.data()),
                   "no data space");
    const H5Handle properties = creation_properties(file(), H5P_DATASET_CREATE);
    file().require(H5Pset_chunk(properties.get(), static_cast<int>(chunk.size()), chunk.data()),
                   "no property list");
    file().require(H5Pset_fill_value(properties.get(), h5_type<T>(), &fill), "no property list");
    file().require(H5Pset_fletcher32(properties.get()), "no property list");
    return {file(),
            file().own(H5Dcreate2(id(), name.c_str(), h5_type<T>(), space.get(), H5P_DEFAULT,
                                  properties.get(), H5P_DEFAULT),
                       "an array cannot be made"),
            child(name)};
}

template <class T>
void H5Group::write(const std::string& name, std::span<const T> values, const H5Extent& extent,
                    Compression compression) const {
    const H5Handle space = h5_space(file(), extent);
    const H5Handle properties = array_properties(file(), extent, sizeof(T), compression);
    const H5Handle data = file().own(H5Dcreate2(id(), name.c_str(), h5_type<T>(), space.get(),
                                                H5P_DEFAULT, properties.get(), H5P_DEFAULT),
                                     "an array cannot be made");
    if (values.empty()) return;
    file().require(H5Dwrite(data.get(), h5_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
                   "data cannot be written");
}

void H5Group::write_text(const std::string& name, const std::string& text) const {
    const H5Handle type = h5_text_type(file(), text.size());
    const H5Handle space = h5_space(file(), {1});
    const H5Handle properties =
        array_properties(file(), {1}, std::max<std::size_t>(text.size(), 1), Compression::none);
    const H5Handle data = file().own(H5Dcreate2(id(), name.c_str(), type.get(), space.get(),
                                                H5P_DEFAULT, properties.get(), H5P_DEFAULT),
                                     "a text cannot be made");
    file().require(H5Dwrite(data.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()),
                   "a text cannot be written");
}

void H5Group::link(const std::string& name, const H5Group& from, const std::string& target) const {
    file().require(
        H5Lcreate_hard(from.id(), target.c_str(), id(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
        "a link cannot be made");
}

template H5Dataset H5Group::make_series(const std::string&, const H5Extent&, const H5Extent&,
                                        double) const;
template H5Dataset H5Group::make_series(const std::string&, const H5Extent&, const H5Extent&,
                                        std::int64_t) const;
template H5Dataset H5Group::make_series(const std::string&, const H5Extent&, const H5Extent&,
                                        std::int8_t) const;
template H5Dataset H5Group::make_series(const std::string&, const H5Extent&, const H5Extent&,
                                        std::uint8_t) const;
template void H5Group::write(const std::string&, std::span<const double>, const H5Extent&,
                             Compression) const;
template void H5Group::write(const std::string&, std::span<const std::int64_t>, const H5Extent&,
                             Compression) const;
template void H5Group::write(const std::string&, std::span<const std::int8_t>, const H5Extent&,
                             Compression) const;
template void H5Group::write(const std::string&, std::span<const std::uint8_t>, const H5Extent&,
                             Compression) const;

}  // namespace grainfield::io
