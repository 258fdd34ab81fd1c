#pragma once

#include <cstdint>

#include "tracking/layers/sphere_cell.h"
#include "tracking/refine/joint_fit.h"
#include "tracking/synthesis/bias_correction.h"

namespace grainfield::tracking {

struct OneForTwo {
    std::int64_t trials = 0;  ///< discs taken away
    std::int64_t kept = 0;    ///< … that stayed away
    std::int64_t steps = 0;   ///< disc updates done
    int rounds = 0;           ///< of trials that were made at once
};

/// Puts one disc in the place of two where spheres have no room between the plates.
///
/// In a crystal of mirror-like spheres whose rows nearly close, n + 1 discs fit a row of n spheres
/// about as well as n do: each is a little too near to the next. None explains little, so that none
/// is doubtful, but together they have no room. A disc that lacks it (SphereRoom, with .05 a
/// granted, .08 a where positions are not corrected) is taken away, and its nearest neighbour goes
/// to the middle of the two. All about it take sweeps. The row is then right or too short. It stays
/// so if
///
///   of the discs that were within 2.5 D at least three fewer lack room, the one that went among
///   them, and
///   the misfit Σ (I − M)² over the square of half side 2.5 D rises by 1.25 of the usual one, or
///   by 36 σ², at most.
///
/// The usual one is the median over three blocks by three about each disc, less the noise
/// (ResidualBlocks). Else those within 2.5 D go back, and all settle. Trials 7.1 D apart are made
/// at once, those that explain least first, in 32 rounds at most. docs/tracking/room.md has what
/// was measured.
///
/// `cell.diameter` > 0 [px]; `correction`: of positions, by which room is judged; `noise` σ > 0
/// [contrast]; `refinement`: tolerance of the sweeps, and their number if less than 30. A frame
/// where all have room costs one judgement of room, and draws all discs where they are. A round
/// costs two judgements, some 4 µs a disc each, and the sweeps. Independent of the number of
/// threads.
OneForTwo try_one_for_two(JointFit& fit, const SphereCell& cell, const BiasCorrection& correction,
                          double noise, const RefinementOptions& refinement);

}  // namespace grainfield::tracking
