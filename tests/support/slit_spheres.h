#pragma once

#include <cstdint>
#include <vector>

#include "core/vec2.h"

namespace grainfield::testing {

/// Hard spheres between two plates and four walls, with known heights. All lengths in a.
struct SlitScene {
    double side = 0;    ///< of the square floor; centres stay half a diameter off the walls
    double height = 0;  ///< distance of the plates L_z
    std::vector<Vec2> position;
    std::vector<double> z;  ///< of the centre over its lowest place, 0 … L_z − 1
};

/// A square bilayer that fills the slit, layers alternating on a checkerboard of projected spacing
/// `spacing` (at least sqrt(1 − (L_z − 1)²) and 1/sqrt(2)), shaken by `sweeps` Metropolis moves per
/// sphere, each uniform in ± `step` per axis and rejected if spheres would overlap in space. Small
/// steps leave a crystal that jitters; with s = .9243 (φ = .919) and long runs it melts to the
/// disordered bilayer.
SlitScene shaken_bilayer(double side, double height, double spacing, double step, int sweeps,
                         std::uint64_t seed);

/// Some more of these moves; `seed` names their random numbers.
void shake(SlitScene& scene, double step, int sweeps, std::uint64_t seed);

/// A bilayer crystal of radius `patch_radius` and spacing `patch_spacing` in the middle of a
/// bilayer liquid whose sites have spacing `liquid_spacing`, shaken likewise.
SlitScene patch_in_liquid(double side, double height, double patch_radius, double patch_spacing,
                          double liquid_spacing, double step, int sweeps, std::uint64_t seed);

/// The least distance in space between two centres [a]; brute force over cells.
double closest_approach(const SlitScene& scene);

}  // namespace grainfield::testing
