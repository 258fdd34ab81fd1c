#include "io/h5/detail/h5_object.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace grainfield::io {

H5Handle h5_text_type(const H5File& file, std::size_t bytes) {
    H5Handle type = file.own(H5Tcopy(H5T_C_S1), "no text type");
    file.require(H5Tset_size(type.get(), std::max<std::size_t>(bytes, 1)), "a text is too long");
    file.require(H5Tset_cset(type.get(), H5T_CSET_UTF8), "no text type");
    file.require(H5Tset_strpad(type.get(), H5T_STR_NULLPAD), "no text type");
    return type;
}

H5Handle h5_space(const H5File& file, const H5Extent& extent) {
    if (extent.empty()) return file.own(H5Screate(H5S_SCALAR), "no data space");
    return file.own(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr),
                    "no data space");
}

std::string unpadded(const char* bytes, std::size_t count) {
    return {bytes, std::find(bytes, bytes + count, '\0')};
}

H5Object::H5Object(const H5File& file, H5Handle handle, std::string path)
    : file_(&file), handle_(std::move(handle)), path_(std::move(path)) {}

bool H5Object::has_attribute(const std::string& name) const {
    return H5Aexists(id(), name.c_str()) > 0;
}

void H5Object::fail_attribute(const std::string& name) const {
    file_->fail(fmt::format("attribute {} of {} is missing or not what it should be", name, path_));
}

H5Handle H5Object::open_attribute(const std::string& name) const {
    H5Handle attribute(H5Aopen(id(), name.c_str(), H5P_DEFAULT));
    if (!attribute) fail_attribute(name);
    return attribute;
}

std::size_t H5Object::entries(const H5Handle& attribute, const std::string& name,
                              std::size_t entry_bytes) const {
    const H5Handle space(H5Aget_space(attribute.get()));
    const hssize_t count = H5Sget_simple_extent_npoints(space.get());
    if (!space || count < 0) fail_attribute(name);
    file_->require_plausible(static_cast<double>(count) * static_cast<double>(entry_bytes), name);
    return static_cast<std::size_t>(count);
}

std::vector<double> H5Object::numbers_attribute(const std::string& name) const {
    const H5Handle attribute = open_attribute(name);
    const H5Handle type(H5Aget_type(attribute.get()));
    const H5T_class_t kind = H5Tget_class(type.get());
    if (kind != H5T_INTEGER && kind != H5T_FLOAT) fail_attribute(name);
    std::vector<double> values(entries(attribute, name, sizeof(double)));
    if (values.empty()) return values;
    if (H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, values.data()) < 0) fail_attribute(name);
    return values;
}

double H5Object::number_attribute(const std::string& name) const {
    const std::vector<double> values = numbers_attribute(name);
    if (values.size() != 1) fail_attribute(name);
    return values.front();
}

std::vector<std::string> H5Object::texts_attribute(const std::string& name) const {
    const H5Handle attribute = open_attribute(name);
    const H5Handle type(H5Aget_type(attribute.get()));
    if (H5Tget_class(type.get()) != H5T_STRING) fail_attribute(name);
    const std::size_t bytes = H5Tget_size(type.get());
    const std::size_t count = entries(attribute, name, bytes);
    std::vector<std::string> texts;
    if (H5Tis_variable_str(type.get()) > 0) {
        std::vector<char*> pointers(count, nullptr);
        if (H5Aread(attribute.get(), type.get(), pointers.data()) < 0) fail_attribute(name);
        for (const char* text : pointers) texts.emplace_back(text != nullptr ? text : "");
        const H5Handle space(H5Aget_space(attribute.get()));
        H5Dvlen_reclaim(type.get(), space.get(), H5P_DEFAULT, pointers.data());
        return texts;
    }
    std::vector<char> buffer(count * bytes);
    if (H5Aread(attribute.get(), type.get(), buffer.data()) < 0) fail_attribute(name);
    for (std::size_t i = 0; i < count; ++i) {
        texts.push_back(unpadded(buffer.data() + i * bytes, bytes));
    }
    return texts;
}

void H5Object::write_attribute(const std::string& name, hid_t type, const H5Extent& extent,
                               const void* values) const {
    const H5Handle space = h5_space(*file_, extent);
    const H5Handle attribute =
        file_->own(H5Acreate2(id(), name.c_str(), type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                   "an attribute cannot be made");
    file_->require(H5Awrite(attribute.get(), type, values), "an attribute cannot be written");
}

void H5Object::set_attribute(const std::string& name, std::span<const std::int64_t> values) const {
    write_attribute(name, H5T_NATIVE_INT64, {values.size()}, values.data());
}

void H5Object::set_attribute(const std::string& name, std::int64_t value) const {
    write_attribute(name, H5T_NATIVE_INT64, {}, &value);
}

void H5Object::set_attribute(const std::string& name, double value) const {
    write_attribute(name, H5T_NATIVE_DOUBLE, {}, &value);
}

void H5Object::set_attribute(const std::string& name, const std::string& text) const {
    write_attribute(name, h5_text_type(*file_, text.size()).get(), {}, text.c_str());
}

void H5Object::set_attribute(const std::string& name, std::span<const std::string> texts) const {
    std::size_t longest = 1;
    for (const std::string& text : texts) longest = std::max(longest, text.size());
    std::vector<char> buffer(texts.size() * longest, '\0');
    for (std::size_t i = 0; i < texts.size(); ++i) {
        std::ranges::copy(texts[i], buffer.begin() + static_cast<std::ptrdiff_t>(i * longest));
    }
    write_attribute(name, h5_text_type(*file_, longest).get(), {texts.size()}, buffer.data());
}

}  // namespace grainfield::io
