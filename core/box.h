#pragma once

#include <array>

#include "core/vec2.h"

namespace grainfield {

/// What a side of the cell does to a particle: it comes back on the other side, or it bounces.
enum class Boundary { periodic, walls };

/// The rectangular cell [origin, origin + length) that particles live in, per axis periodic or
/// walled. Lengths carry the length unit of the trajectory that owns the box.
///
/// A video has no box of its own: the tracker sets it to the region of interest with walls, so
/// that origin is the outer edge of the first pixel (-0.5, -0.5) for a full frame.
struct Box {
    Vec2 origin;
    Vec2 length;
    std::array<Boundary, 2> boundary{Boundary::walls, Boundary::walls};
    double height = 0;  ///< distance between the plates [length unit]; 0 if unknown

    double area() const { return length.x * length.y; }
    bool is_periodic() const {
        return boundary[0] == Boundary::periodic && boundary[1] == Boundary::periodic;
    }
    bool contains(Vec2 p) const;

    /// The shortest image of the displacement d: |component| <= length/2 on periodic axes,
    /// unchanged on walled ones. Cost O(1) for any |d|.
    Vec2 minimum_image(Vec2 d) const;

    /// The image of p inside [origin, origin + length) on periodic axes.
    Vec2 wrap(Vec2 p) const;

    friend bool operator==(const Box&, const Box&) = default;
};

/// Throws OptionError unless both lengths are finite and positive and the height is not negative.
void require_valid(const Box& box);

}  // namespace grainfield
