#pragma once

#include <vector>

#include "app/validation_outcome.h"
#include "app/validation_thresholds.h"
#include "report/report.h"

namespace grainfield::app {

/// The tables and figures of scores that a validation adds to the report of its two runs.
report::ReportAdditions validation_report(const ValidationOutcome& outcome,
                                          const std::vector<ThresholdCheck>& checks);

}  // namespace grainfield::app
