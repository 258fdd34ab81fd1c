#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/h5/detail/h5_handle.h"

namespace grainfield::io {

/// Lengths of the axes of an array, slowest first.
using H5Extent = std::vector<hsize_t>;

/// What groups and datasets share: a place in a file, and attributes by name. All failures go
/// through H5File::fail. The H5File must outlive it.
class H5Object {
 public:
    H5Object() = default;
    H5Object(const H5File& file, H5Handle handle, std::string path);

    explicit operator bool() const { return static_cast<bool>(handle_); }
    const H5File& file() const { return *file_; }
    const std::string& path() const { return path_; }

    bool has_attribute(const std::string& name) const;
    double number_attribute(const std::string& name) const;
    std::vector<double> numbers_attribute(const std::string& name) const;
    std::vector<std::string> texts_attribute(const std::string& name) const;

    void set_attribute(const std::string& name, std::span<const std::int64_t> values) const;
    void set_attribute(const std::string& name, std::int64_t value) const;
    void set_attribute(const std::string& name, double value) const;
    void set_attribute(const std::string& name, const std::string& text) const;
    void set_attribute(const std::string& name, std::span<const std::string> texts) const;

 protected:
    hid_t id() const { return handle_.get(); }

 private:
    H5Handle open_attribute(const std::string& name) const;
    [[noreturn]] void fail_attribute(const std::string& name) const;
    std::size_t entries(const H5Handle& attribute, const std::string& name,
                        std::size_t entry_bytes) const;
    void write_attribute(const std::string& name, hid_t type, const H5Extent& extent,
                         const void* values) const;

    const H5File* file_ = nullptr;
    H5Handle handle_;
    std::string path_;
};

/// A type for texts of up to `bytes` bytes of UTF-8, padded with zero bytes.
H5Handle h5_text_type(const H5File& file, std::size_t bytes);

/// No extent: a single value.
H5Handle h5_space(const H5File& file, const H5Extent& extent);

/// Up to the first zero byte.
std::string unpadded(const char* bytes, std::size_t count);

}  // namespace grainfield::io
