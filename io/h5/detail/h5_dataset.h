#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/h5/detail/h5_object.h"

namespace grainfield::io {

/// The memory type of a C++ number: double, std::int64_t, std::int8_t or std::uint8_t.
template <class T>
hid_t h5_type();

/// What the entries of an array are; texts are no numbers.
enum class NumberKind { none, integer, real };

/// An array in a file.
class H5Dataset : public H5Object {
 public:
    using H5Object::H5Object;

    H5Extent extent() const;
    NumberKind kind() const;
    std::string extent_text() const;  ///< "[12, 11704, 3]"

    /// The whole array. Fails if it is not one of numbers.
    template <class T>
    std::vector<T> read() const;

    /// Entry `row` of the first axis, whole.
    template <class T>
    std::vector<T> read_row(hsize_t row) const;

    /// Makes the first axis `rows` long and the second at least `columns` (ignored if there is
    /// none); what is new holds the fill value.
    void extend(hsize_t rows, hsize_t columns) const;

    /// Writes values over the first `columns` entries of the second axis of entry `row`; for arrays
    /// of one axis the single entry `row`.
    template <class T>
    void write_row(hsize_t row, hsize_t columns, std::span<const T> values) const;

 private:
    H5Handle select(hsize_t row, const H5Extent& count) const;
    void require_number() const;
};

}  // namespace grainfield::io
