#include "app/simulate_md_command.h"

#include <chrono>
#include <cmath>
#include <optional>
#include <system_error>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "core/support/progress.h"
#include "io/h5/checkpoint_file.h"
#include "io/h5/trajectory_file.h"
#include "io/open_snapshots.h"
#include "io/output_file.h"
#include "pipelines/md/order_series.h"
#include "pipelines/md/snapshot_segments.h"
#include "simulate/md/initial_state.h"
#include "simulate/md/md_simulation.h"

namespace grainfield::app {

namespace {

using nlohmann::ordered_json;
using simulate::MdSimulation;
using Clock = std::chrono::steady_clock;

std::string quoted(const std::filesystem::path& path) {
    return "'" + path.string() + "'";
}

ordered_json facts(const MdSimulation& simulation, std::int64_t events, double seconds) {
    const auto& series = simulation.series();
    ordered_json facts;
    facts["periods"] = simulation.periods_done();
    facts["events"] = simulation.events();
    facts["events_per_second"] = seconds > 0 ? static_cast<double>(events) / seconds : 0;
    facts["pair_per_grain_period"] = series.late_mean("pair");
    facts["low_plate_per_grain_period"] = series.late_mean("low_plate");
    facts["high_plate_per_grain_period"] = series.late_mean("high_plate");
    facts["energy_xy"] = series.late_mean("energy_xy");
    facts["energy_z"] = series.late_mean("energy_z");
    facts["energy_rotation"] = series.late_mean("energy_rotation");
    facts["pressure"] = series.late_mean("pressure");
    facts["energy_audit_relative_error"] = simulation.energy_audit();
    facts["max_overlap"] = simulation.max_overlap();
    facts["max_penetration"] = simulation.max_penetration();
    facts["max_step_back"] = simulation.backwards();
    facts["fallbacks"] = simulation.fallbacks();
    facts["outdated_per_event"] = simulation.outdated_per_event();
    facts["memory_mb"] = static_cast<double>(simulation.bytes()) / 1e6;
    facts["engine"] = simulation.policies();
    return facts;
}

std::string words(const std::string& output, const ordered_json& facts, double seconds) {
    std::string text =
        fmt::format("{}: {:g} periods, {} events in {}, {:.3g} events/s\n", output,
                    facts["periods"].get<double>(), facts["events"].get<std::int64_t>(),
                    format_duration(seconds), facts["events_per_second"].get<double>());
    text += fmt::format(
        "  per grain and period (later half)  pair {:.3f}, low plate {:.3f}, high plate {:.3f}\n",
        facts["pair_per_grain_period"].get<double>(),
        facts["low_plate_per_grain_period"].get<double>(),
        facts["high_plate_per_grain_period"].get<double>());
    text +=
        fmt::format("  energy per grain                   xy {:.4f}, z {:.4f}, rotation {:.4f}\n",
                    facts["energy_xy"].get<double>(), facts["energy_z"].get<double>(),
                    facts["energy_rotation"].get<double>());
    text += fmt::format(
        "  energy audit {:.1e}, deepest overlap {:.1e} a, in plates {:.1e} a, memory {:.0f} MB\n",
        facts["energy_audit_relative_error"].get<double>(), facts["max_overlap"].get<double>(),
        facts["max_penetration"].get<double>(), facts["memory_mb"].get<double>());
    return text;
}

}  // namespace

std::string SimulateMdCommand::purpose() const {
    return "hard spheres between vibrating plates, event by event";
}

Command::Inputs SimulateMdCommand::inputs() const {
    return {.placeholder = "", .meaning = "", .count = Count::none};
}

std::vector<OptionTable> SimulateMdCommand::options() {
    OptionTable own("");
    own.text("output", output_, "trajectory file to write (H5MD)");
    own.text("start", start_, "trajectory to start from instead of the initial layout");
    own.integer("start-frame", start_frame_, "-", {-1, 1e15}, "snapshot to start from, -1: last");
    own.flag("resume", resume_, "go on from OUTPUT.checkpoint");
    own.flag("order", order_, "also mean |Q4| and share of solid grains of each snapshot");
    own.number("checkpoint-every", checkpoint_every_, "min", {0, 1e6}, "time between checkpoints");
    std::vector<OptionTable> tables{own};
    for (OptionTable& table : simulate::describe(md_)) tables.push_back(std::move(table));
    return tables;
}

simulate::GrainState SimulateMdCommand::initial_state(const Session& session) const {
    const auto seed = static_cast<std::uint64_t>(session.common.seed);
    if (start_.empty()) return simulate::make_initial_state(md_, seed);
    const auto source = io::open_snapshots(start_, std::nullopt, {});
    if (source->count() == 0) {
        throw InputError(
            {.problem = fmt::format("cannot start from {}", quoted(std::filesystem::path(start_))),
             .actual = "it holds no snapshots",
             .expected = "at least one",
             .suggestion = "was run.discard longer than the run?"});
    }
    const std::int64_t frame = start_frame_ < 0 ? source->count() - 1 : start_frame_;
    if (frame < 0 || frame >= source->count()) {
        throw OptionError({.problem = "start-frame: no such snapshot",
                           .actual = std::to_string(start_frame_),
                           .expected = fmt::format("0 … {}", source->count() - 1),
                           .suggestion = {}});
    }
    return simulate::state_of(source->read(frame), source->info(), md_, seed);
}

std::vector<std::pair<std::string, std::string>> SimulateMdCommand::physics(
    const Session& session) const {
    std::vector<std::pair<std::string, std::string>> kept;
    for (const auto& [name, value] : session.configuration) {
        const bool section = name.find('.') != std::string::npos;
        const bool own = name == "seed" || name == "start" || name == "start-frame";
        if ((section && name != "run.tiles") || own) kept.emplace_back(name, value);
    }
    return kept;
}

void SimulateMdCommand::save(const Session& session, const MdSimulation& simulation,
                             pipelines::SnapshotSegments& segments) const {
    segments.close();
    Checkpoint checkpoint = simulation.checkpoint();
    checkpoint.configuration = physics(session);
    checkpoint.integers["segments"] = {segments.count()};
    io::write_checkpoint(checkpoint, checkpoint_path());
}

void SimulateMdCommand::run_to_end(Session& session, MdSimulation& simulation,
                                   pipelines::SnapshotSegments& segments) const {
    Progress progress("simulating", static_cast<std::int64_t>(md_.run.periods), "periods",
                      session.common.verbosity());
    progress.resume_at(static_cast<std::int64_t>(simulation.periods_done()));
    auto last_saved = Clock::now();
    const std::chrono::duration<double> interval(60 * checkpoint_every_);
    while (!simulation.is_done() && caught_signal() == 0) {
        const double before = simulation.periods_done();
        const std::int64_t events = simulation.events();
        simulation.run_window(segments);
        progress.count(simulation.events() - events, "events");
        progress.advance(static_cast<std::int64_t>(simulation.periods_done() - before));
        if (Clock::now() - last_saved >= interval && !simulation.is_done()) {
            save(session, simulation, segments);
            last_saved = Clock::now();
        }
    }
}

std::optional<Checkpoint> SimulateMdCommand::load_checkpoint(const Session& session) const {
    if (!resume_) return std::nullopt;
    Checkpoint checkpoint = io::read_checkpoint(checkpoint_path());
    if (checkpoint.kind != "md") {
        throw InputError({.problem = fmt::format("cannot go on from {}", quoted(checkpoint_path())),
                          .actual = fmt::format("a checkpoint of kind '{}'", checkpoint.kind),
                          .expected = "md",
                          .suggestion = {}});
    }
    io::require_same_configuration(checkpoint, physics(session), checkpoint_path());
    return checkpoint;
}

std::int64_t SimulateMdCommand::segments_of(const Checkpoint& checkpoint) const {
    const auto found = checkpoint.integers.find("segments");
    if (found == checkpoint.integers.end() || found->second.size() != 1 ||
        found->second.front() < 0) {
        throw InputError({.problem = fmt::format("cannot go on from {}", quoted(checkpoint_path())),
                          .actual = "it has no number of 'segments'",
                          .expected = {},
                          .suggestion = "start again without --resume"});
    }
    return found->second.front();
}

void SimulateMdCommand::finish(Session& session, const MdSimulation& simulation,
                               pipelines::SnapshotSegments& segments,
                               io::TrajectoryWriter& writer) const {
    if (order_) {
        pipelines::OrderSeries order(writer, simulation.period(), simulation.info().diameter);
        segments.merge_into(order);
        writer.add_curve(order.curve());
    } else {
        segments.merge_into(writer);
    }
    writer.add_curve(simulation.series().curve());
    writer.finish(session.record());
    segments.remove();
    std::error_code ignored;
    std::filesystem::remove(checkpoint_path(), ignored);
    session.outputs.push_back(output_);
}

void SimulateMdCommand::plan_snapshots(RunPlan& plan) const {
    const simulate::RunOptions& run = md_.run;
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

Summary SimulateMdCommand::run(Session& session) {
    if (!order_) {
        session.plan.skip("order parameters", "not asked for (--order)", "|Q4| of every snapshot");
    }
    plan_snapshots(session.plan);
    if (session.common.explain) {
        if (start_.empty()) {
            session.plan.run("initial state", "made from [initial]");
        } else {
            session.plan.run("initial state",
                             fmt::format("{} grains of {}", initial_state(session).size(), start_));
            session.plan.skip("layout", "--start gives it", "packing and melting");
        }
        const MdSimulation planned(md_, {}, session.threads(), session.plan);
        return explanation(session.plan);
    }
    require_output(session, output_);
    require_hdf5_name(output_);
    if (!start_.empty()) session.inputs.emplace_back(start_);
    std::error_code ignored;
    const bool has_checkpoint = std::filesystem::exists(checkpoint_path(), ignored);
    if (has_checkpoint && !resume_ && !session.common.force) {
        throw OutputError({.problem = fmt::format("'{}' exists: an interrupted run of '{}'",
                                                  checkpoint_path().string(), output_),
                           .actual = {},
                           .expected = {},
                           .suggestion = "go on with --resume, or start anew with --force"});
    }
    const std::optional<Checkpoint> checkpoint = load_checkpoint(session);
    simulate::GrainState initial;
    if (!checkpoint) initial = initial_state(session);
    MdSimulation simulation(md_, std::move(initial), session.threads(), session.plan);
    if (checkpoint) simulation.restore(*checkpoint, quoted(checkpoint_path()));

    const auto overwrite = session.common.force ? io::Overwrite::force : io::Overwrite::refuse;
    io::TrajectoryWriter writer(output_, simulation.info(), overwrite);
    pipelines::SnapshotSegments segments(output_, simulation.info(),
                                         checkpoint ? segments_of(*checkpoint) : 0);
    const auto start = Clock::now();
    const std::int64_t events_before = simulation.events();
    std::string failure;
    try {
        run_to_end(session, simulation, segments);
    } catch (const PhysicsError& error) {
        failure = error.what();
        session.plan.warn(WarningCode::incomplete,
                          fmt::format("incomplete: what was sampled before it failed, in or after "
                                      "period {:g} of {:g}: {}",
                                      simulation.periods_done(), md_.run.periods, failure));
    }
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    const ordered_json result = facts(simulation, simulation.events() - events_before, seconds);

    Summary summary{.text = words(output_, result, seconds), .facts = result};
    summary.failure = failure;
    bool is_complete = simulation.is_done() || !failure.empty();
    if (is_complete) {
        try {
            finish(session, simulation, segments, writer);
        } catch (const Interrupted&) {
            if (!failure.empty()) {
                session.plan.warn(fmt::format(
                    "'{0}' was not written: a signal came while its snapshots were joined; they "
                    "are in {0}.segment-*",
                    output_));
                return summary;
            }
            is_complete = false;
        }
    }
    if (!is_complete) {
        save(session, simulation, segments);
        session.outputs.push_back(checkpoint_path());
        session.plan.warn(fmt::format("interrupted after {:g} of {:g} periods; go on with --resume",
                                      simulation.periods_done(), md_.run.periods));
        summary.signal = caught_signal();
    }
    return summary;
}

}  // namespace grainfield::app
