#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/snapshot.h"
#include "core/unit.h"

namespace grainfield::io {

/// What one line of a table of points says; missing numbers are NaN, a missing identity −1.
struct Point {
    std::int64_t frame = 0;
    std::int64_t particle = -1;
    Vec2 position;
    double z = 0;
    Vec2 position_error;
    double z_error = 0;
    double quality = 0;
    double layer = 0;  ///< as the table numbers them
};

/// Whether a table must say which frame its points are of.
enum class FrameColumn {
    required,
    optional  ///< without it all points are of frame 0
};

/// Reads the lines of a table of points whose header it has seen: finds the columns by name, in any
/// order, among others. Errors name file, line and field. Not thread-safe.
class PointsLine {
 public:
    explicit PointsLine(std::filesystem::path path, FrameColumn frames = FrameColumn::required)
        : path_(std::move(path)), frames_(frames) {}

    /// Throws InputError if frame, x or y is missing or a column occurs twice. x_px and y_px are x
    /// and y.
    void read_header(std::string_view line, std::int64_t number);

    /// Throws InputError if a field is absent or not a number.
    Point read(std::string_view line, std::int64_t number);

    /// The unit that the names of x and y state; empty: they state none.
    std::optional<LengthUnit> length_unit() const { return length_unit_; }

    /// The number of the bottom layer, 0 or 1; the top one has the next.
    void number_layers_from(int first) { first_layer_ = first; }

    /// Adds the point to those columns of the snapshot that the table has.
    void append(const Point& point, Snapshot& snapshot) const;

    /// `line` 0: the file as a whole.
    [[noreturn]] void fail(std::int64_t line, const std::string& actual,
                           const std::string& expected = {}) const;

    /// Whether the line holds nothing, or a comment that starts with #.
    static bool is_blank(std::string_view line);

 private:
    enum Field : std::size_t {
        frame,
        particle,
        x,
        y,
        z,
        x_std,
        y_std,
        z_std,
        layer,
        quality,
        field_count
    };
    static const std::array<std::string_view, field_count> names;

    bool has(Field field) const;
    void take_column(Field field, std::size_t index, std::int64_t line);
    std::string_view text(Field field) const;
    double number(Field field) const;
    double number_or_missing(Field field) const;
    std::int64_t integer(Field field) const;

    std::filesystem::path path_;
    FrameColumn frames_;
    std::optional<LengthUnit> length_unit_ = {};
    int first_layer_ = 0;
    std::array<std::size_t, field_count> column_{};  ///< where each field stands
    std::vector<std::string_view> fields_;           ///< of the line being read
    std::int64_t line_ = 0;
};

}  // namespace grainfield::io
