#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "core/trajectory.h"
#include "pipelines/job.h"
#include "pipelines/resumable.h"
#include "simulate/md/md_options.h"

namespace grainfield::pipelines {

/// What one run of molecular dynamics is asked for.
struct MdJobOptions {
    std::filesystem::path output;
    std::string start;              ///< trajectory to start from; empty: the initial layout
    std::int64_t start_frame = -1;  ///< snapshot of it, -1: the last
    bool order = false;             ///< also mean |Q4| and share of solid grains of each snapshot
    ResumeOptions resume{.resume = false, .every = std::chrono::minutes(10)};
    simulate::MdOptions md;
};

/// Collisions per grain and period, and energies per grain, over the later half of the run.
struct MdMeans {
    double pair = 0, low_plate = 0, high_plate = 0;           ///< [1/period]
    double energy_xy = 0, energy_z = 0, energy_rotation = 0;  ///< [m a g]
    double pressure = 0;
};

/// What a run, or the part of it until a signal, did.
struct MdJobResult {
    double periods = 0;            ///< since the start, before a resume included
    std::int64_t events = 0;       ///< likewise
    std::int64_t snapshots = 0;    ///< sampled so far
    double discarded = 0;          ///< of the periods, before the first snapshot
    double events_per_second = 0;  ///< of this call
    double seconds = 0;            ///< of this call, simulation alone
    MdMeans means;
    double energy_audit = 0;     ///< |energy change + losses − work| over the energy turned over
    double max_overlap = 0;      ///< of two grains [a]
    double max_penetration = 0;  ///< of a grain into plates and walls [a]
    double max_step_back = 0;    ///< in time, from one event to the next [sqrt(a/g)]
    std::int64_t fallbacks = 0;  ///< windows that several threads left to one
    double outdated_per_event = 0;
    double memory_mb = 0;
    simulate::VibrationOptions::Motion motion;  ///< of the plates, A [a] and ω [sqrt(g/a)]
    TrajectoryInfo info;                        ///< as the file has it
    std::string engine;                         ///< its policies
    std::string failure;                        ///< the check that ended the run early; empty: none
    int signal = 0;                             ///< that ended it early; 0: none
};

/// Says in the plan what run_md would do. Throws what the options and the start call for.
void plan_md(const MdJobOptions& options, Job& job);

/// Simulates to the end and writes the trajectory; at a signal leaves a checkpoint from which
/// `resume` goes on bit by bit (Resumable, log ".snapshots"). What was sampled before a
/// PhysicsError is written too, and the error is in the result. Throws OptionError, InputError,
/// OutputError.
MdJobResult run_md(const MdJobOptions& options, Job& job);

}  // namespace grainfield::pipelines
