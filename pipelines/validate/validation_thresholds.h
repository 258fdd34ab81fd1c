#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/option_table.h"

namespace grainfield::pipelines {

struct ValidationOutcome;

/// What a scene has to reach; what is not set is not checked. A quantity that could not be measured
/// misses its threshold.
struct ValidationThresholds {
    std::optional<double> recall;             ///< least, class all [-]
    std::optional<double> recall_crystal;     ///< least [-]
    std::optional<double> precision;          ///< least, class all [-]
    std::optional<double> rmse;               ///< largest per axis, class all [px]
    std::optional<double> rmse_crystal;       ///< largest per axis [px]
    std::optional<double> bound_ratio;        ///< largest, class all [-]
    std::optional<double> correct_links;      ///< least share [-]
    std::optional<double> layers_named;       ///< least share of all found [-]
    std::optional<double> layers_up_to_flip;  ///< least share [-]
    std::optional<double> alpha;              ///< least [-]
    std::optional<double> q4_error;           ///< largest RMS error of |Q4| [-]
};

OptionTable describe(ValidationThresholds& thresholds);

/// One threshold and what was measured.
struct ThresholdCheck {
    std::string name;  ///< as in the scene file
    std::string unit;
    double limit = 0;
    double value = 0;  ///< NaN: not measured
    bool is_least = true;
    bool met() const { return is_least ? value >= limit : value <= limit; }
    /// "recall 0.981, at least 0.999 asked for"; "recall not measured, at least 0.999 asked for"
    std::string text() const;
};

/// The thresholds that are set, in the order of the table.
std::vector<ThresholdCheck> check(const ValidationThresholds& thresholds,
                                  const ValidationOutcome& outcome);

}  // namespace grainfield::pipelines
