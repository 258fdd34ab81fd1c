#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace grainfield::report {

using Colour = std::array<std::uint8_t, 3>;  ///< sRGB

/// The perceptually uniform colour map "viridis" (`smith2015`) at t in [0, 1], interpolated
/// linearly in sRGB between eleven anchors; t outside is clamped, NaN gives grey.
Colour viridis(double t);

/// Colour `index` of `count` that must be told apart: the palette of `okabe2008` up to seven, safe
/// for colour-blind readers and dark enough on white. Beyond that steps along viridis, without its
/// light end, so that neighbours in a series of runs have neighbouring colours.
Colour distinct_colour(std::size_t index, std::size_t count);

/// "#0072b2"
std::string hex(Colour colour);

}  // namespace grainfield::report
