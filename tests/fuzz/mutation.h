#pragma once

#include <string>
#include <vector>

#include "core/support/random.h"

namespace grainfield::fuzz {

/// A damaged copy of one of the seeds: up to eight changes, each one of
///
///   - a bit, a byte, a number of 2, 4 or 8 bytes (either byte order), a double;
///   - a number of a text;
///   - a piece that is left out, doubled, or taken from another seed; an end that is cut off.
///
/// Numbers are those at which code fails: 0, ±1, the limits of integers, NaN, infinity. The same
/// stream gives the same copies. `seeds` must not be empty.
std::string mutated(const std::vector<std::string>& seeds, RandomStream& random);

}  // namespace grainfield::fuzz
