#pragma once

#include <vector>

#include "analysis/analysis_options.h"
#include "analysis/measure_settings.h"
#include "analysis/observable.h"
#include "analysis/run.h"
#include "core/box.h"
#include "core/run_plan.h"
#include "core/trajectory.h"

namespace grainfield::analysis {

/// What one pass over a source gives.
struct Gathered {
    Run run;
    Box box;               ///< of the first snapshot [length unit of the source]
    double particles = 0;  ///< sum over snapshots
};

/// Measures the observables of all snapshots, a few at a time; see `measure`.
Gathered gather(SnapshotSource& source, const std::vector<Observable>& wanted,
                const AnalysisOptions& options, const MeasureSettings& settings,
                const PartOfRun& part, RunPlan& plan);

}  // namespace grainfield::analysis
