#pragma once

#include <string>
#include <vector>

#include "core/results.h"
#include "core/vec2.h"

namespace grainfield::report {

/// A spot of a frame where picture and image model differ much more than elsewhere: something was
/// missed there, seen twice, or is no sphere. Or a sphere that is marked for another reason.
struct Place {
    Vec2 position;        ///< of the worst sphere [length unit]
    double residual = 0;  ///< its local RMS residual [contrast]
    int spheres = 0;      ///< how many it joins
    std::string words{};  ///< why it is marked; empty: for its residual
};

/// Spheres whose local residual (`Snapshot::quality`) is over four times the median of the frame;
/// those within two diameters of one another are one place. Worst first. None where the residual is
/// not known or nothing differs. O(n log n), and O(m²) for m such spheres, at most 400 of the
/// worst.
std::vector<Place> places_to_look_at(const Snapshot& snapshot, double diameter);

}  // namespace grainfield::report
