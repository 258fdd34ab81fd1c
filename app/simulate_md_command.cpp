#include "app/simulate_md_command.h"

#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "pipelines/lab.h"

namespace grainfield::app {

namespace {

using nlohmann::ordered_json;
using pipelines::MdJobResult;

ordered_json facts(const MdJobResult& result) {
    ordered_json facts;
    facts["periods"] = result.periods;
    facts["snapshots"] = result.snapshots;
    facts["periods_discarded"] = result.discarded;
    facts["events"] = result.events;
    facts["events_per_second"] = result.events_per_second;
    facts["amplitude"] = result.motion.amplitude;
    facts["angular_frequency"] = result.motion.angular_frequency;
    facts["gamma"] = result.info.control ? ordered_json(result.info.control->value) : nullptr;
    facts["pair_per_grain_period"] = result.means.pair;
    facts["low_plate_per_grain_period"] = result.means.low_plate;
    facts["high_plate_per_grain_period"] = result.means.high_plate;
    facts["energy_xy"] = result.means.energy_xy;
    facts["energy_z"] = result.means.energy_z;
    facts["energy_rotation"] = result.means.energy_rotation;
    facts["pressure"] = result.means.pressure;
    facts["energy_audit_relative_error"] = result.energy_audit;
    facts["max_overlap"] = result.max_overlap;
    facts["max_penetration"] = result.max_penetration;
    facts["max_step_back"] = result.max_step_back;
    facts["fallbacks"] = result.fallbacks;
    facts["outdated_per_event"] = result.outdated_per_event;
    facts["memory_mb"] = result.memory_mb;
    facts["engine"] = result.engine;
    return facts;
}

/// A and ω of the plates, and what a lab calls them.
std::string motion_in_words(const MdJobResult& result, const LabUnits& lab) {
    std::string text = fmt::format("A = {:.5g} a, ω = {:.5g} sqrt(g/a)", result.motion.amplitude,
                                   result.motion.angular_frequency);
    const std::string known = pipelines::vibration_in_words(result.info, lab);
    if (!known.empty()) text += "; " + known;
    if (lab.sphere_mm) {
        text += fmt::format("; spheres of {:.5g} mm, 1 sqrt(a/g) is {:.5g} s", *lab.sphere_mm,
                            seconds_of_time_unit(*lab.sphere_mm));
    }
    return text;
}

std::string words(const std::string& output, const MdJobResult& result, const LabUnits& lab) {
    const auto& means = result.means;
    std::string text =
        fmt::format("{}: {:g} periods, {} events in {}, {:.3g} events/s\n", output, result.periods,
                    result.events, format_duration(result.seconds), result.events_per_second);
    text += fmt::format("  {}", counted(result.snapshots, "snapshot"));
    if (result.discarded > 0) {
        text += fmt::format(" ({:g} of {:g} periods discarded)", result.discarded, result.periods);
    }
    text += "\n  vibration  " + motion_in_words(result, lab) + "\n";
    text += fmt::format(
        "  per grain and period (later half)  pair {:.3f}, low plate {:.3f}, high plate {:.3f}\n",
        means.pair, means.low_plate, means.high_plate);
    text +=
        fmt::format("  energy per grain                   xy {:.4f}, z {:.4f}, rotation {:.4f}\n",
                    means.energy_xy, means.energy_z, means.energy_rotation);
    text += fmt::format(
        "  energy audit {:.1e}, deepest overlap {:.1e} a, in plates {:.1e} a, memory {:.0f} MB\n",
        result.energy_audit, result.max_overlap, result.max_penetration, result.memory_mb);
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
    own.text("start", job_.start, "trajectory to start from instead of the initial layout");
    own.integer("start-frame", job_.start_frame, "-", {-1, 1e15},
                "snapshot to start from, -1: last");
    own.flag("resume", job_.resume.resume, "go on from OUTPUT.checkpoint if it is there");
    own.affects(Effect::call);  // a run that was gone on with is recorded as one
    own.flag("order", job_.order, "also mean |Q4| and share of solid grains of each snapshot");
    own.number("checkpoint-every", checkpoint_every_, "min", {0, 1e6}, "time between checkpoints");
    own.affects(Effect::work);
    std::vector<OptionTable> tables{own};
    for (OptionTable& table : simulate::describe(job_.md)) tables.push_back(std::move(table));
    return tables;
}

void SimulateMdCommand::make_room_for(const GivenText& given) {
    using Given = simulate::VibrationOptions::Given;
    job_.md.vibration.make_room_for([&](const std::string& name) {
        const std::string text = given("vibration", name);
        return text.empty() ? Given::no : text == automatic ? Given::as_auto : Given::as_value;
    });
}

std::vector<std::string> SimulateMdCommand::usual() const {
    return {"output", "grains",  "length-x", "length-y", "height",
            "gamma",  "periods", "start",    "resume",   "threads"};
}

std::string SimulateMdCommand::default_output(
    const std::vector<std::filesystem::path>& /*inputs*/) const {
    return "md.h5";
}

Summary SimulateMdCommand::run(Session& session) {
    job_.output = output_;
    job_.resume.every = std::chrono::duration<double>(60 * checkpoint_every_);
    if (session.common.explain) {
        pipelines::plan_md(job_, session);
        return explanation(session.plan);
    }
    require_output(session, output_);
    require_hdf5_name(output_);
    const MdJobResult result = pipelines::run_md(job_, session);
    return {.text = words(output_, result, job_.md.vibration.lab),
            .facts = facts(result),
            .signal = result.signal,
            .failure = result.failure};
}

}  // namespace grainfield::app
