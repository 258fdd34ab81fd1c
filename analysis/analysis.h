#pragma once

#include <string>
#include <vector>

#include "analysis/density/number_variance.h"
#include "analysis/density/synthetic_result.h"
#include "analysis/motion/displacement.h"
#include "analysis/order/bond_order.h"
#include "analysis/order/phase.h"
#include "analysis/spectra/fit_result.h"
#include "analysis/spectra/order_structure_factor.h"
#include "analysis/spectra/structure_factor.h"
#include "core/results.h"
#include "core/run_plan.h"
#include "core/support/progress.h"
#include "core/trajectory.h"

namespace grainfield::analysis {

struct AnalysisOptions {
    std::string observables = "all";  ///< comma list of the names below, or all
    BondOrderOptions q4;
    PhaseOptions phase;
    DisplacementOptions msd;
    StructureFactorOptions sk;
    OrderStructureFactorOptions s4;
    NumberVarianceOptions variance;
    FitOptions fit;
    SyntheticOptions synthetic;
    std::vector<Vec2> wavevectors{};  ///< for S(k) beyond its grid [1/a]
};

/// One table per section: analysis, q4, phase, msd, sk, s4, variance, fit, synthetic.
std::vector<OptionTable> describe(AnalysisOptions& options);

/// Says in `plan` what `analyze` will run and leave out, and why, from the source's properties and
/// its first snapshot. Throws OptionError for an unknown observable.
void plan_analysis(SnapshotSource& source, const AnalysisOptions& options, RunPlan& plan);

/// Measures the chosen observables over all snapshots of the source.
///
/// Snapshots are read in order, a few at a time; each batch is measured by up to `threads` threads,
/// while the next one is read and the one before is added in order, so the results are the same
/// bits for any number of threads. Lengths are turned into units of a (TrajectoryInfo::diameter);
/// times keep the unit of the trajectory. An observable that cannot be measured comes back with a
/// `reason`. Observables come in the order q4, phase, msd, sk, s4, variance, fit, synthetic.
///
/// Memory: a few snapshots and the accumulators (see the classes); only msd grows with the number
/// of frames, up to its bound. Throws OptionError (options), InputError (inconsistent snapshots,
/// box that changes), Interrupted.
std::vector<ObservableResult> analyze(SnapshotSource& source, const AnalysisOptions& options,
                                      int threads, RunPlan& plan, Progress& progress);

}  // namespace grainfield::analysis
