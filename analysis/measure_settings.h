#pragma once

#include <cstdint>

#include "core/run_plan.h"
#include "core/support/progress.h"

namespace grainfield::analysis {

/// How a measurement is carried out; results do not depend on it.
struct MeasureSettings {
    int threads = 0;               ///< 0: all of the machine
    RunPlan* plan = nullptr;       ///< takes what is measured, left out and warned of
    Progress* progress = nullptr;  ///< advances by one a snapshot
};

/// Where a part stands in its run.
struct PartOfRun {
    std::int64_t first = 0;  ///< number of its first snapshot
    std::int64_t whole = 0;  ///< snapshots of the run; 0: the part is the run
};

}  // namespace grainfield::analysis
