#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/results.h"
#include "report/run_identity.h"
#include "report/page/table.h"

namespace grainfield::report {

/// A number of the paper and what it is to be compared with.
struct PaperValue {
    std::string name;         ///< "Γc, experiment"
    std::string origin;       ///< of the runs that measure it; "critical" with `label`
    std::string label;        ///< of results of `critical`; else empty
    std::string observable;   ///< "critical"
    std::string measurement;  ///< "critical_value"
    double value = 0;         ///< [-]
    double error = 0;         ///< as the paper gives it, or half of its last digit
    bool is_rounded = false;  ///< the paper gives no error, and "about"
};

/// The numbers of `castillo2019` that a run of this program measures.
const std::vector<PaperValue>& paper_values();

/// "agrees" (within 2 standard errors of both together), "differs by 3.1 σ", or "not resolved at
/// this scale": no value, no error, or an error above a quarter of the paper's value.
std::string verdict(const PaperValue& paper, const Measurement* ours);

/// The table "paper's value, ours, verdict", one row a value. Of several runs that measure it the
/// one with the largest control parameter speaks. Values that no run measures stay in the table.
Table paper_table(const std::vector<Results>& runs, const std::vector<std::string>& labels,
                  const std::vector<RunIdentity>& identities);

}  // namespace grainfield::report
