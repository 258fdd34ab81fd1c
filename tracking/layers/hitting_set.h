#pragma once

#include <cstdint>
#include <vector>

namespace grainfield::tracking {

struct HittingSet {
    std::vector<std::uint32_t> members;  ///< ascending
    bool exact = true;                   ///< false: some group of sets exceeded the budget
};

/// The lightest set of elements that meets every one of `sets`.
///
/// Sets that share elements form groups, solved one by one: branch and bound over the elements of
/// the smallest set not yet met, bounded below by a packing of disjoint sets. A group that needs
/// more than `budget` branches gets the best set found, at least as good as the greedy one (weight
/// per set met) freed of superfluous members. Elements index `weight` (> 0); no set may be empty.
HittingSet minimum_hitting_set(const std::vector<std::vector<std::uint32_t>>& sets,
                               const std::vector<double>& weight, std::int64_t budget = 20000);

}  // namespace grainfield::tracking
