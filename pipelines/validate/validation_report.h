#pragma once

#include <vector>

#include "pipelines/validate/validation_outcome.h"
#include "pipelines/validate/validation_thresholds.h"
#include "report/report.h"

namespace grainfield::pipelines {

/// The tables and figures of scores that a validation adds to the report of its two runs.
report::ReportAdditions validation_report(const ValidationOutcome& outcome,
                                          const std::vector<ThresholdCheck>& checks);

}  // namespace grainfield::pipelines
