#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace grainfield::io {

/// The layout of what our trajectory files keep under /parameters/grainfield.
inline constexpr std::int64_t trajectory_version = 1;

/// The optional columns of a snapshot. A file notes for each frame which of them it has, as the
/// sum of 1 << column: padding alone cannot tell "all values missing" from "no such column".
enum class TrajectoryColumn : std::uint8_t {
    id,
    z,
    velocity,
    spin,
    position_error,
    quality,
    layer,
    z_error
};

/// H5MD element under particles/trajectory; z is the third column of position.
inline constexpr std::array<const char*, 8> trajectory_column_names{
    "id", "z", "velocity", "spin", "position_error", "quality", "layer", "z_error"};

constexpr std::size_t index_of(TrajectoryColumn column) {
    return static_cast<std::size_t>(column);
}

constexpr std::uint8_t bit_of(TrajectoryColumn column) {
    return static_cast<std::uint8_t>(1U << index_of(column));
}

}  // namespace grainfield::io
