#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/vec2.h"

namespace grainfield::tracking {

/// Spheres of equal size between two plates.
struct SphereCell {
    double diameter = 0;  ///< true diameter a, not that of the dark disc [px]
    double height = 0;    ///< distance of the plates L_z; an upper bound errs on the safe side [a]
    double camera_distance = 0;  ///< of a pinhole from the spheres, Z [a]; 0: telecentric
    Vec2 axis{};                 ///< where its optical axis meets the frame [px]

    /// What the height of a centre can vary by, H = L_z − a [a].
    double slack() const { return height - 1; }

    /// No two centres are nearer in projection: δ ≤ H, d ≥ sqrt(1 − H²) [a]. 0.341 at 1.94 a.
    double least_distance() const { return std::sqrt(std::max(0.0, 1 - slack() * slack())); }

    /// Of three centres two are at least so far apart: both smaller δ add up to H at most, so that
    /// one has δ ≤ H/2, d ≥ sqrt(1 − H²/4) [a]. 0.883 at 1.94 a.
    double least_of_three() const { return std::sqrt(std::max(0.0, 1 - 0.25 * slack() * slack())); }

    /// What perspective can do to the distance of two spheres around `place`: spheres at different
    /// heights, a distance R from the axis, are displaced by up to R H / Z against each other, and
    /// magnified by up to 1 + H / Z [a].
    double parallax(Vec2 place) const {
        return camera_distance > 0 ? (norm(place - axis) / diameter + 1) * slack() / camera_distance
                                   : 0;
    }
};

/// Least difference in height δ of two centres that are `distance` apart in projection, both [a].
///
///     δ = sqrt(1 − d²)
///
/// 0 from contact on (d ≥ 1 within rounding).
double rise_at(double distance);

/// Whether three spheres that overlap one another, each pair with its rise > 0, fit within `slack`:
/// the one in the middle is as far from the others as the two smaller rises [a].
bool three_fit(double one, double other, double third, double slack);

/// Whether a sphere at `place` fits between the plates beside `neighbours`, all those nearer than
/// a.
///
/// It does if the rise δ over each of them stays below H, and so does the sum of the two smaller
/// rises of every three spheres that overlap one another. Distances may be too short by `granted`.
///
///     δ = sqrt(1 − (d/a + granted)²) [a]
///
/// Positions in px, `granted` in a. O(n²) for n neighbours. Parallax is left out.
bool has_room(const SphereCell& cell, Vec2 place, const std::vector<Vec2>& neighbours,
              double granted);

}  // namespace grainfield::tracking
