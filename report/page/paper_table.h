#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/results.h"
#include "report/page/table.h"

namespace grainfield::report {

/// A number of the paper and what it is to be compared with.
struct PaperValue {
    std::string name;         ///< "Γc, experiment"
    RunIdentity series;       ///< the runs, or the critical point of runs, that measure it
    std::string observable;   ///< "critical"
    std::string measurement;  ///< "critical_value"
    double value = 0;         ///< [-]
    double error = 0;         ///< as the paper gives it; of a rounded value what it is taken for
    bool is_rounded = false;  ///< the paper gives no error, and "about"
    std::string panel{};      ///< of the paper's figures, where it is marked: "2b"; may be empty
};

/// The numbers of `castillo2019` that a run of this program measures.
const std::vector<PaperValue>& paper_values();

enum class Agreement { agrees, differs, unresolved };

/// What our value says of the paper's.
struct Verdict {
    Agreement agreement = Agreement::unresolved;
    double apart = 0;  ///< |difference| in standard errors of both together, where resolved

    /// "agrees", "differs by 3.1 σ" or "not resolved at this scale"
    std::string text() const;
};

/// Agrees within 2 standard errors of both together; unresolved: no value, no error, or an error
/// above a quarter of the paper's value.
Verdict verdict(const PaperValue& paper, const Measurement* ours);

/// The paper's number with its error, "≈" before a rounded one.
std::string paper_text(const PaperValue& paper);

/// The same with the error that it is compared with: "≈ 0.95, taken as ± 0.025".
std::string paper_text_with_error(const PaperValue& paper);

/// What the runs say about it: of several runs that measure it the one with the largest control
/// parameter, one with an error before those without.
struct PaperMeasurement {
    const Measurement* measurement = nullptr;  ///< null: no run measures it
    std::size_t run = 0;
};
PaperMeasurement paper_measurement(const PaperValue& paper, const std::vector<Results>& runs);

/// The table "paper's value, ours, verdict", one row a value. Of several runs that measure it the
/// one with the largest control parameter speaks. Values that no run measures stay in the table.
Table paper_table(const std::vector<Results>& runs, const std::vector<std::string>& labels);

}  // namespace grainfield::report
