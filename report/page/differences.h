#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/quantity_titles.h"
#include "core/results.h"
#include "report/page/table.h"
#include "report/run_labels.h"

namespace grainfield::report {

/// Two runs put side by side, indices into the runs.
struct RunPair {
    std::size_t first = 0;
    std::size_t second = 0;
};

/// The runs that differ in origin only: same control parameter, same frame rate where both know
/// one, no fields (another dimension or b is another model). Of two runs in all, those two.
std::vector<RunPair> pairs_of(const std::vector<Results>& runs,
                              const std::vector<RunIdentity>& identities);

/// Name of their table.
inline constexpr std::string_view differences_name = "differences";

/// Differences in units of their error, one column a pair, one row a quantity that both runs of
/// some pair measured with an error:
///
///   (first − second) / sqrt(σ_first² + σ_second²)
///
/// and for each spectrum a row with the root mean square of it over the shells of k that both have
/// with an error, at least 8. Shells must be independent: S(k) and S4(k) of periodic boxes, and
/// S(k) of the modes between walls. Errors are taken as independent; two analyses of the same
/// frames share most of theirs, so that their differences are smaller than the number says. At most
/// 40 pairs. Nothing if there is no such quantity.
std::optional<Table> differences(const std::vector<Results>& runs,
                                 const std::vector<std::string>& labels,
                                 const std::vector<RunIdentity>& identities,
                                 const std::vector<ObservableTitles>& titles);

/// Which runs have times in different units, and which options put them into one; empty if none.
std::string time_mismatch(const std::vector<Results>& runs, const std::vector<std::string>& labels);

/// What stands in the way of comparing runs, one sentence each: versions of the program, units of
/// length and time, dimensions, runs without any error.
std::vector<std::string> mismatches(const std::vector<Results>& runs,
                                    const std::vector<std::string>& labels,
                                    const std::vector<RunIdentity>& identities);

}  // namespace grainfield::report
