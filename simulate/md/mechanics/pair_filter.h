#pragma once

#include <cstddef>
#include <cstdint>

#include "simulate/md/mechanics/flight.h"

namespace grainfield::simulate {

/// Entries that `near` of a PairFilter must have beyond `count`.
constexpr std::size_t pair_filter_room = 4;

/// Of the grains `near[0 … count)`, moves those that touch `grain` before `limit`, if nothing else
/// happens, to the front of `near`, in their order; their number.
///
///   f + 2 b (limit − t) ≤ 0,  b < 0,  b² − v² f ≥ 0 or f ≤ 0        (symbols of pair_time)
///
/// Exactly the candidates for which pair_time is not `never`: the same operations, several grains
/// at a time. `shift` is added to the positions of all. Cost: about a third of pair_time a grain.
using PairFilter = std::size_t (*)(const Grain& grain, const Grain* grains, const Vec3& shift,
                                   double gravity, double limit, std::int32_t* near,
                                   std::size_t count);

/// The filter for this processor.
template <bool has_gravity>
PairFilter pair_filter();

}  // namespace grainfield::simulate
