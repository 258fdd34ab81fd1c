#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/results.h"
#include "core/vec2.h"

namespace grainfield::analysis {

/// Displacements of one group of particles at one lag, both axes.
struct VanHoveGroup {
    std::vector<double> counts;  ///< by bin, of |Δx| and |Δy|
    double number = 0;           ///< of displacements, 2 a pair of sightings
    double squares = 0;          ///< Σ Δx² + Δy² [a²]
    double fourths = 0;          ///< Σ Δx⁴ + Δy⁴ [a⁴]

    /// Adds the displacement of a pair of sightings; bins of `width`.
    void add(Vec2 d, double width);
};

/// Number of bins of |Δx|; what lies beyond the last is counted in `number` only.
constexpr std::size_t van_hove_bins = 30;

/// The sum of the groups, all but number `without`.
VanHoveGroup pooled(std::span<const VanHoveGroup> groups, std::size_t without);

/// Appends the rows of one lag to the curve `van_hove` (x, t as text "lag", g, err) of `result`,
/// which is made when it is not there, and the measurement alpha2_lag_<lag>. Errors: jackknife over
/// the groups that hold displacements, at least four, with Student's factor.
void add_van_hove_lag(std::span<const VanHoveGroup> groups, double width, std::int64_t lag,
                      double time, ObservableResult& result);

/// A well-mixed hash of an identity: groups and thinning go by it.
inline std::uint64_t identity_hash(std::int64_t id) {
    // The finaliser of SplitMix64: spreads consecutive identities evenly.
    auto z = static_cast<std::uint64_t>(id) + 0x9e3779b97f4a7c15U;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31);
}

}  // namespace grainfield::analysis
