#pragma once

#include <vector>

#include "pipelines/validate/validation_thresholds.h"
#include "report/page/table.h"

namespace grainfield::pipelines {

/// What a scene had to reach, and whether it did.
report::Table threshold_table(const std::vector<ThresholdCheck>& checks);

}  // namespace grainfield::pipelines
