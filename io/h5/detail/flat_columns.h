#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/snapshot.h"

namespace grainfield::io {

/// The columns of a snapshot as the flat arrays of numbers that files hold, and back.
std::vector<double> flat(const std::vector<Vec2>& column);
std::vector<double> flat(const std::vector<Vec3>& column);
std::vector<std::int8_t> flat(const std::vector<Layer>& column);

/// The first two of every `width` numbers.
std::vector<Vec2> vec2s(const std::vector<double>& numbers, std::size_t width);
std::vector<Vec3> vec3s(const std::vector<double>& numbers);
/// Anything but 0 and 1 is Layer::unknown.
std::vector<Layer> layers(const std::vector<std::int8_t>& numbers);

}  // namespace grainfield::io
