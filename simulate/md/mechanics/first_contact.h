#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "simulate/md/mechanics/flight.h"

namespace grainfield::simulate {

/// The contact of a grain with one of several candidates.
struct Contact {
    double time = never;
    std::int32_t partner = -1;  ///< index of the grain; -1: none
};

/// Grains that may touch another one, and the periodic image of each that is meant.
struct Candidates {
    static constexpr std::size_t room = 192;
    static constexpr std::size_t spare = 8;  ///< entries beyond `room` that may be written
    std::array<std::int32_t, room + spare> id;
    std::array<double, room + spare> shift_x;  ///< [a], added to its position
    std::array<double, room + spare> shift_y;
    std::array<double, room + spare> shift_z;
    std::size_t count = 0;
    bool is_shifted = false;  ///< otherwise no shift is read
};

/// The first of the contacts of `grain` with the candidates, if one comes before `limit`:
///
///   min of pair_time over all candidates; the first in their order where times are equal.
///
/// The operations are those of pair_time, without fused ones, for several candidates at a time: the
/// same bits on every processor. The choice among the candidates does not branch. Writes to the
/// entries of `candidates` beyond `count`.
using ContactSearch = Contact (*)(const Grain& grain, const Grain* grains, double gravity,
                                  double limit, Candidates& candidates);

/// The search for this processor.
template <bool has_gravity>
ContactSearch contact_search();

}  // namespace grainfield::simulate
