#pragma once

#include <cstddef>
#include <span>

#include "tracking/model/overlap_rule.h"
#include "tracking/model/profile_shape.h"

namespace grainfield::tracking {

/// The parts of image models that options can name. A new one is added to the list in
/// known_models.cpp, and nowhere else. The order stays: saved states refer to it.
std::span<const ProfileShape* const> profile_shapes();
std::span<const OverlapRule* const> overlap_rules();

/// Where a rule stands in the list. Throws std::out_of_range for one that does not.
std::size_t number_of(const OverlapRule& rule);
std::size_t number_of(const ProfileShape& shape);

}  // namespace grainfield::tracking
