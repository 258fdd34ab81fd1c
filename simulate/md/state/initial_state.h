#pragma once

#include <cstdint>

#include "core/snapshot.h"
#include "core/trajectory.h"
#include "simulate/md/engine/engine.h"
#include "simulate/md/md_options.h"
#include "simulate/md/state/grain_state.h"

namespace grainfield::simulate {

/// Grains to begin with, at the instant when the plates pass their mean position upwards.
///
/// Layout `random`: low cells (under 3 a) get one grain per site of a lattice of spacing ≥ 1 with
/// random empty sites and random heights. Where that holds too few, they get a square bilayer,
/// which elastic collisions then melt. Tall cells start from a face-centred cubic lattice, melted
/// too. `square`: a square bilayer patch in the middle, liquid around it. Velocities are
/// Maxwellian, without total momentum on periodic axes; spins are zero. Depends on options and seed
/// only. Throws OptionError, before anything is run, if so many grains do not fit (with the number
/// that does); Interrupted if a signal comes while it melts.
GrainState make_initial_state(const MdOptions& options, std::uint64_t seed);

/// Deepest overlap [a] of grains, or of grain and plate, that a window may begin with. Rounding
/// makes 1e-14 in the largest cells.
constexpr double permitted_overlap = 1e-9;

/// The grains of a snapshot; missing velocities are drawn, missing spins are zero. `source`: the
/// trajectory it comes from, whose vibration tells the phase. Throws OptionError if cell, number of
/// grains or phase (not 0) differ from what the options say; InputError if heights are missing, or
/// grains lie outside the cell or overlap by more than `permitted_overlap`.
GrainState state_of(const Snapshot& snapshot, const TrajectoryInfo& source,
                    const MdOptions& options, std::uint64_t seed);

/// Brings grains that are near in space near in memory (Z order of cells).
void sort_in_space(GrainState& state);

}  // namespace grainfield::simulate
