#include "pipelines/md/md_job.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "core/support/progress.h"
#include "io/h5/snapshot_log.h"
#include "io/h5/trajectory_file.h"
#include "io/open_snapshots.h"
#include "pipelines/configuration.h"
#include "pipelines/interrupt_deadline.h"
#include "pipelines/lab.h"
#include "pipelines/md/order_series.h"
#include "simulate/md/md_simulation.h"
#include "simulate/md/md_size.h"
#include "simulate/md/state/initial_state.h"

namespace grainfield::pipelines {

namespace {

using simulate::MdSimulation;
using Clock = std::chrono::steady_clock;

simulate::GrainState initial_state(const MdJobOptions& options, std::uint64_t seed) {
    if (options.start.empty()) return simulate::make_initial_state(options.md, seed);
    const auto source = io::open_snapshots(options.start, std::nullopt, {});
    if (source->count() == 0) {
        throw InputError({.problem = fmt::format("cannot start from '{}'", options.start),
                          .actual = "it holds no snapshots",
                          .expected = "at least one",
                          .suggestion = "was run.discard longer than the run?"});
    }
    const std::int64_t frame = options.start_frame < 0 ? source->count() - 1 : options.start_frame;
    if (frame < 0 || frame >= source->count()) {
        throw OptionError({.problem = "start-frame: no such snapshot",
                           .actual = std::to_string(options.start_frame),
                           .expected = fmt::format("0 … {}", source->count() - 1),
                           .suggestion = {}});
    }
    return simulate::state_of(source->read(frame), source->info(), options.md, seed);
}

/// What a resumed run must have in common with the one before.
Resumable::Identity identity_of(const MdJobOptions& options, std::uint64_t seed) {
    simulate::MdOptions md = options.md;
    Configuration physics = physics_of(simulate::describe(md));
    physics.emplace_back("seed", std::to_string(seed));
    physics.emplace_back("start", options.start);
    physics.emplace_back("start-frame", std::to_string(options.start_frame));
    return {.kind = "md",
            .output = options.output,
            .log = ".snapshots",
            .configuration = std::move(physics),
            .record = options.output,
            .cures = {"run.contact-time", "run.event-limit"}};
}

/// With A and ω in numbers, however they were given, also in the record of the run.
MdJobOptions in_numbers(const MdJobOptions& given, Job& job) {
    MdJobOptions options = given;
    const auto motion = options.md.vibration.motion(options.md.cell.gravity);
    options.md.vibration.amplitude = motion.amplitude;
    options.md.vibration.angular_frequency = motion.angular_frequency;
    update(job.configuration, simulate::describe(options.md));
    return options;
}

void require_room(const MdJobOptions& options, Job& job) {
    require_room(simulate::size_of(options.md), available_memory(),
                 "use fewer cell.grains, a smaller cell, fewer run.periods or a longer "
                 "run.sample-every",
                 job.size_check, job.plan);
}

void plan_snapshots(const MdJobOptions& options, RunPlan& plan) {
    const simulate::RunOptions& run = options.md.run;
    if (!options.order) {
        plan.skip("order parameters", "not asked for (order)", "|Q4| of every snapshot");
    }
    const double first = run.discard + run.snapshot_phase;
    if (first > run.periods) {
        plan.skip("snapshots", fmt::format("the first would come after {:g} periods", first),
                  "the trajectory");
        plan.warn(
            fmt::format("no snapshot will be written: the run lasts {:g} periods, of which "
                        "{:g} are discarded; lower run.discard or raise run.periods",
                        run.periods, run.discard));
        return;
    }
    plan.run("snapshots",
             fmt::format("{:.0f}, every {:g} periods from {:g} on",
                         std::floor((run.periods - first) / run.snapshot_every * (1 + 1e-12)) + 1,
                         run.snapshot_every, first));
}

void save(const MdSimulation& simulation, Resumable& resumable) {
    // Snapshots of a window that a signal cut short are made again.
    resumable.save(simulation.checkpoint(), simulation.settled_snapshots());
}

void run_to_end(double periods, MdSimulation& simulation, SnapshotSink& sink, Resumable& resumable,
                Verbosity verbosity) {
    Progress progress("simulating", static_cast<std::int64_t>(periods), "periods", verbosity);
    progress.resume_at(static_cast<std::int64_t>(simulation.periods_done()));
    while (!simulation.is_done() && caught_signal() == 0) {
        const double before = simulation.periods_done();
        const std::int64_t events = simulation.events();
        simulation.run_window(sink);
        progress.count(simulation.events() - events, "events");
        progress.advance(static_cast<std::int64_t>(simulation.periods_done() - before));
        if (resumable.is_due() && !simulation.is_done()) save(simulation, resumable);
    }
}

void copy(const io::SnapshotLog& log, SnapshotSink& sink) {
    for (std::int64_t i = 0; i < log.count(); ++i) {
        const Snapshot snapshot = log.read(i);
        throw_if_interrupted("writing the snapshots");
        sink.write(snapshot);
    }
}

/// Snapshots and time series to the output file. Throws Interrupted; nothing is lost then.
void write_trajectory(const MdSimulation& simulation, const MdJobOptions& options, const Job& job,
                      const io::SnapshotLog& log, io::TrajectoryWriter& writer) {
    if (options.order) {
        OrderSeries order(writer, simulation.period(), simulation.info().diameter);
        copy(log, order);
        writer.add_curve(order.curve());
    } else {
        copy(log, writer);
    }
    if (const auto lab = curve_of(options.md.vibration.lab)) writer.add_curve(*lab);
    writer.add_curve(simulation.series().curve());
    writer.finish(job.record());
}

MdJobResult result_of(const MdSimulation& simulation, const MdJobOptions& options,
                      std::int64_t events, double seconds) {
    const auto& series = simulation.series();
    MdJobResult result;
    result.periods = simulation.periods_done();
    result.events = simulation.events();
    result.snapshots = simulation.settled_snapshots();
    result.discarded = std::min(options.md.run.discard, result.periods);
    result.events_per_second = seconds > 0 ? static_cast<double>(events) / seconds : 0;
    result.seconds = seconds;
    result.means = {.pair = series.late_mean("pair"),
                    .low_plate = series.late_mean("low_plate"),
                    .high_plate = series.late_mean("high_plate"),
                    .energy_xy = series.late_mean("energy_xy"),
                    .energy_z = series.late_mean("energy_z"),
                    .energy_rotation = series.late_mean("energy_rotation"),
                    .pressure = series.late_mean("pressure")};
    result.energy_audit = simulation.energy_audit();
    result.max_overlap = simulation.max_overlap();
    result.max_penetration = simulation.max_penetration();
    result.max_step_back = simulation.backwards();
    result.fallbacks = simulation.fallbacks();
    result.outdated_per_event = simulation.outdated_per_event();
    result.memory_mb = static_cast<double>(simulation.bytes()) / 1e6;
    result.engine = simulation.policies();
    result.motion = options.md.vibration.motion(options.md.cell.gravity);
    result.info = simulation.info();
    return result;
}

}  // namespace

void plan_md(const MdJobOptions& given, Job& job) {
    const MdJobOptions options = in_numbers(given, job);
    const DiscardDeadline deadline("the plan", options.output.string());
    require_room(options, job);
    plan_snapshots(options, job.plan);
    if (options.start.empty()) {
        job.plan.run("initial state", "made from [initial]");
    } else {
        job.plan.run(
            "initial state",
            fmt::format("{} grains of {}", initial_state(options, job.seed).size(), options.start));
        job.plan.skip("layout", "the start gives it", "packing and melting");
    }
    Resumable(job, identity_of(options, job.seed), options.resume).explain();
    const MdSimulation planned(options.md, {}, job.threads, job.plan);
}

MdJobResult run_md(const MdJobOptions& given, Job& job) {
    const MdJobOptions options = in_numbers(given, job);
    plan_snapshots(options, job.plan);
    if (!options.start.empty()) job.inputs.emplace_back(options.start);
    std::optional<DiscardDeadline> starting(std::in_place, "the simulation",
                                            options.output.string());
    require_room(options, job);
    Resumable resumable(job, identity_of(options, job.seed), options.resume);
    resumable.require_free();
    starting.reset();
    const InterruptDeadline deadline([&](int signal) { return resumable.cut_off(signal); });
    simulate::GrainState initial;
    if (resumable.from() == nullptr) initial = initial_state(options, job.seed);
    MdSimulation simulation(options.md, std::move(initial), job.threads, job.plan);
    if (resumable.from() != nullptr) {
        simulation.restore(*resumable.from(),
                           fmt::format("'{}'", resumable.checkpoint_path().string()));
    }
    io::TrajectoryWriter writer(options.output, simulation.info(), resumable.overwrite());
    resumable.start();
    io::SnapshotLog log(resumable.log());

    const auto start = Clock::now();
    const std::int64_t events_before = simulation.events();
    std::string failure;
    std::string cure;  // how to go on after the failure
    try {
        run_to_end(options.md.run.periods, simulation, log, resumable, job.verbosity);
    } catch (const PhysicsError& error) {
        failure = error.what();
        if (dynamic_cast<const simulate::InelasticCollapse*>(&error) != nullptr) {
            // Before the snapshots are written, which may fail or be stopped.
            resumable.save_failed(simulation.checkpoint(), simulation.settled_snapshots(), failure);
            cure = fmt::format(" With another run.contact-time, {} goes on from there.",
                               options.resume.how);
        }
        job.plan.warn(WarningCode::incomplete,
                      fmt::format("incomplete: what was sampled before it failed, in or after "
                                  "period {:g} of {:g}: {}",
                                  simulation.periods_done(), options.md.run.periods, failure));
    }
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    MdJobResult result =
        result_of(simulation, options, simulation.events() - events_before, seconds);
    result.failure = failure + cure;
    if (!failure.empty()) result.snapshots = log.count();
    if (failure.empty()) save(simulation, resumable);
    if (simulation.is_done() || !failure.empty()) {
        try {
            write_trajectory(simulation, options, job, log, writer);
            job.outputs.push_back(options.output);
            if (cure.empty()) resumable.finish();
            return result;
        } catch (const Interrupted&) {
            if (!failure.empty()) {
                job.plan.warn(
                    fmt::format("'{}' was not written: a signal came before its "
                                "snapshots were in it",
                                options.output.string()));
                return result;
            }
        }
    }
    job.outputs.push_back(resumable.checkpoint_path());
    const double done = simulation.periods_done();
    Warning warning = resumable.interrupted(done, options.md.run.periods, "periods");
    if (done < options.md.run.periods && simulation.settled_snapshots() > 0) {
        warning.text += fmt::format(", and with run.periods = {:.10g} writes what there is", done);
    }
    job.plan.warn(std::move(warning));
    result.signal = caught_signal();
    return result;
}

}  // namespace grainfield::pipelines
