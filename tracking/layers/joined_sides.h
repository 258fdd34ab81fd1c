#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace grainfield::tracking {

/// What one overlap says about the sides of two groups of spheres.
struct SideLink {
    std::uint32_t first = 0, second = 0;
    double opposite = 0;  ///< logarithm of the odds that they are on opposite sides, to alike
};

struct JoinedSides {
    std::vector<std::uint32_t> group;  ///< one number each, that of its first member
    std::vector<char> turned;          ///< on the other side than that member
};

/// Joins groups whose sides the links tell by odds of exp(`least`) or more.
///
/// The two with the largest sum |Σ ± ln odds| of all links between them are joined first, and the
/// sums are then those of the joined one (greedy additive edge contraction [keuper2015]). Members
/// whose own links to the rest of their group amount to less than `least` in the end are cut out
/// and stand alone, the weakest first. What is left is a group as far as links hold it together.
/// Links between the same two add up. The order of equal sums is that of the numbers.
/// O(links log links) for bounded numbers of neighbours.
JoinedSides join_sides(std::size_t count, const std::vector<SideLink>& links, double least);

}  // namespace grainfield::tracking
