#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/h5/detail/h5_dataset.h"
#include "io/h5/detail/h5_object.h"

namespace grainfield::io {

enum class Compression { none, gzip };

/// A group in a file: children by name. Children that are links to other files, or keep their data
/// in other files, are refused.
class H5Group : public H5Object {
 public:
    using H5Object::H5Object;
    static H5Group root(const H5File& file);

    bool has(const std::string& name) const;
    bool has_group(const std::string& name) const;
    std::vector<std::string> names() const;  ///< of the children, in alphabetical order
    H5Group group(const std::string& name) const;
    H5Dataset dataset(const std::string& name) const;
    std::string text(const std::string& name) const;

    H5Group make_group(const std::string& name) const;
    /// An array without entries on its first axis, which `extend` makes longer.
    /// `row` = lengths of the other axes, of which the first may grow too; one chunk holds
    /// `chunk[0]` entries of the first axis, and so on.
    template <class T>
    H5Dataset make_series(const std::string& name, const H5Extent& row, const H5Extent& chunk,
                          T fill) const;
    template <class T>
    void write(const std::string& name, std::span<const T> values, const H5Extent& extent,
               Compression compression = Compression::none) const;
    void write_text(const std::string& name, const std::string& text) const;
    /// Makes `name` another name of `target`, a child of `from`.
    void link(const std::string& name, const H5Group& from, const std::string& target) const;

 private:
    std::string child(const std::string& name) const { return path() + "/" + name; }
    void refuse_foreign_link(const std::string& name) const;
};

}  // namespace grainfield::io
