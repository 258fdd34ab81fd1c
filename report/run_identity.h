#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/results.h"

namespace grainfield::report {

/// What a run is and at which control parameter: what legends name and what puts runs side by side.
struct RunIdentity {
    std::string origin{};     ///< "tracked", "true positions", "MD", "field, 2D, b = 4", "points"
    std::string parameter{};  ///< "Γ" or "ν"; empty: not known
    std::optional<double> value{};  ///< of the parameter [-]
    int dimension = 2;              ///< 1: a field on a line
    bool is_field = false;          ///< lengths in l, not in a
};

/// From the records of the run: Γ = Aω²/g of `simulate md` or as `analyze --gamma` was told, ν of
/// `simulate field`. A rendered truth counts as "true positions", a film as "tracked". Results of
/// `critical` have the origin "critical".
RunIdentity identity_of(const Results& run);
std::vector<RunIdentity> identities_of(const std::vector<Results>& runs);

/// Whether there are only fields on a line.
bool all_on_a_line(const std::vector<RunIdentity>& identities);

/// "MD, Γ = 2.25"; the origin alone where the parameter is not known.
std::string legend_of(const RunIdentity& identity);

/// The origins in the order of first appearance, critical points left out.
std::vector<std::string> origins_of(const std::vector<RunIdentity>& identities);

}  // namespace grainfield::report
