#pragma once

#include <vector>

#include "analysis/analysis_options.h"
#include "analysis/observable.h"
#include "analysis/observables.h"
#include "core/option_table.h"
#include "core/results.h"
#include "core/run_plan.h"
#include "core/support/progress.h"
#include "core/trajectory.h"

namespace grainfield::analysis {

/// How a measurement is carried out; results do not depend on it.
struct MeasureSettings {
    int threads = 0;               ///< 0: all of the machine
    RunPlan* plan = nullptr;       ///< takes what is measured, left out and warned of
    Progress* progress = nullptr;  ///< advances by one a snapshot
};

/// Measures observables over all snapshots of a trajectory.
///
///     Results results = measure(trajectory);
///     double order = *results.find("q4")->find_measurement("q4_mean")->value;
///
/// Snapshots are read in order, a few at a time; each batch is measured by up to `threads` threads,
/// while the next one is read and the one before is added in order, so the results are the same
/// bits for any number of threads. Lengths are turned into units of a (TrajectoryInfo::diameter);
/// times keep the unit of the trajectory. An observable that cannot be measured comes back with a
/// `reason`. Observables come in the order of `known`; what several need is measured once.
///
/// Memory: a few snapshots and the accumulators (see the classes); only msd grows with the number
/// of frames, up to its bound. Throws OptionError (options), InputError (inconsistent snapshots,
/// box that changes), Interrupted.
Results measure(SnapshotSource& source, const AnalysisOptions& options = {},
                const MeasureSettings& settings = {},
                const std::vector<Observable>& known = observables());
Results measure(const Trajectory& trajectory, const AnalysisOptions& options = {},
                const MeasureSettings& settings = {},
                const std::vector<Observable>& known = observables());

/// Says in `plan` what `measure` will run and leave out, and why, from the source's properties and
/// its first snapshot. Throws OptionError for an unknown observable.
void plan_measurement(SnapshotSource& source, const AnalysisOptions& options, RunPlan& plan,
                      const std::vector<Observable>& known = observables());

/// The choice of observables, and one table for each that has options.
std::vector<OptionTable> describe(AnalysisOptions& options,
                                  const std::vector<Observable>& known = observables());

}  // namespace grainfield::analysis
