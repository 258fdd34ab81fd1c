#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "analysis/analysis_options.h"
#include "analysis/measure_settings.h"
#include "analysis/observable.h"
#include "analysis/observables.h"
#include "core/option_table.h"
#include "core/results.h"
#include "core/run_plan.h"
#include "core/support/checkpoint.h"
#include "core/support/progress.h"
#include "core/trajectory.h"

namespace grainfield::analysis {

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

/// What the accumulators gather from a part of a run, to be merged with that of the other parts.
///
/// Of the observables asked for those are measured that can be merged (Observable::can_be_saved);
/// the others follow particles through time, and the plan says that they are left out. Throws as
/// `measure` does, and OptionError if nothing that was asked for can be merged.
Checkpoint measure_part(SnapshotSource& source, const PartOfRun& part,
                        const AnalysisOptions& options = {}, const MeasureSettings& settings = {},
                        const std::vector<Observable>& known = observables());

/// The results of a run from those of its parts in order, and the options that they were measured
/// with. Values and errors are those of `measure` over the whole run up to the rounding of sums;
/// where snapshots are missing, the blocks of time that errors are taken from shift. One part is in
/// memory at a time: `next` gives them one after the other, then nothing. Throws InputError if
/// parts do not fit each other.
Results merged(const std::function<std::optional<Checkpoint>()>& next,
               const AnalysisOptions& options = {}, const MeasureSettings& settings = {},
               const std::vector<Observable>& known = observables());

/// Says in `plan` what `measure` will run and leave out, and why, from the source's properties and
/// its first snapshot. Throws OptionError for an unknown observable.
void plan_measurement(SnapshotSource& source, const AnalysisOptions& options, RunPlan& plan,
                      const std::vector<Observable>& known = observables());

/// The choice of observables, and one table for each that has options.
std::vector<OptionTable> describe(AnalysisOptions& options,
                                  const std::vector<Observable>& known = observables());

}  // namespace grainfield::analysis
