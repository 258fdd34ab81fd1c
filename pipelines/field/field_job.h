#pragma once

#include <filesystem>

#include "analysis/spectra/structure_factor.h"
#include "pipelines/job.h"
#include "pipelines/resumable.h"
#include "simulate/field/field_plan.h"

namespace grainfield::pipelines {

/// What one run of the field model is asked for.
struct FieldJobOptions {
    std::filesystem::path output;
    ResumeOptions resume;
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

/// Says in the plan of the job what run_field would do. Throws OptionError, InputError
/// (checkpoint).
void plan_field(const FieldJobOptions& options, Job& job);

/// Simulates to the end and writes the field file; at a signal leaves a checkpoint from which
/// `resume` goes on bit by bit (Resumable, log ".fields"). Throws OutputError, InputError
/// (checkpoint), OptionError, PhysicsError (fields that are no longer finite).
FieldJobResult run_field(const FieldJobOptions& options, Job& job);

}  // namespace grainfield::pipelines
