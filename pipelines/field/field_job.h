#pragma once

#include <filesystem>

#include "analysis/spectra/structure_factor.h"
#include "pipelines/session.h"
#include "simulate/field/field_plan.h"

namespace grainfield::pipelines {

/// What one run of the field model is asked for.
struct FieldJobOptions {
    std::filesystem::path output;
    bool resume = false;
    double checkpoint_every = 60;  ///< [s] of wall time
    simulate::FieldOptions field;
    analysis::StructureFactorOptions sk;
};

/// What a run, or the part of it until a signal, did.
struct FieldJobResult {
    std::int64_t steps = 0;  ///< since the start, before a resume included
    double ms_per_step = 0;  ///< of this call; 0 if it took none
    double mass_drift = 0;   ///< |mean now − mean at the start| / standard deviation of a cell
    double memory_mb = 0;    ///< fields and tables
    std::string scheme;
    std::vector<ObservableResult> statistics;
    int signal = 0;
};

/// Runs the plan to its end and writes the field file; at a signal leaves a checkpoint
/// (`<output>.checkpoint`, `<output>.fields`) from which `resume` goes on bit by bit, as it does
/// after a kill from the last periodic one. Both are removed at the end.
/// Throws OutputError, InputError (checkpoint), OptionError.
FieldJobResult run_field_job(const FieldJobOptions& options, const simulate::FieldPlan& plan,
                             Session& session);

}  // namespace grainfield::pipelines
