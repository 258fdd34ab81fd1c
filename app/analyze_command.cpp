#include "app/analyze_command.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/support/progress.h"
#include "pipelines/analyze/part_job.h"
#include "pipelines/interrupt_deadline.h"
#include "report/text.h"

namespace grainfield::app {

namespace {

using nlohmann::ordered_json;

ordered_json to_json(const Measurement& m) {
    ordered_json object;
    object["name"] = m.name;
    object["unit"] = m.unit.text();
    if (m.value) object["value"] = *m.value;
    if (m.error) object["error"] = *m.error;
    object["samples"] = m.samples;
    if (!m.reason.empty()) object["reason"] = m.reason;
    return object;
}

// The first measurement stands for the observable; all of them are under "measurements".
ordered_json to_json(const ObservableResult& observable) {
    ordered_json object;
    if (!observable.measurements.empty()) object = to_json(observable.measurements.front());
    if (!observable.reason.empty()) object["reason"] = observable.reason;
    object["seconds"] = observable.seconds;
    object["measurements"] = ordered_json::array();
    for (const Measurement& m : observable.measurements) {
        object["measurements"].push_back(to_json(m));
    }
    return object;
}

std::string words(const Measurement& m, TimeUnit time_unit) {
    const std::string unit = typeset_text(m.unit, time_unit);
    std::string text = fmt::format("    {:<18} ", m.name);
    if (m.value) text += report::with_error(*m.value, m.error ? &*m.error : nullptr);
    if (m.value && !unit.empty()) text += " " + unit;
    if (!m.reason.empty()) text += fmt::format("{}({})", m.value ? " " : "- ", m.reason);
    return text + "\n";
}

// A line for each; one for neighbours that are missing for one reason.
std::string words(const std::vector<Measurement>& measurements, TimeUnit time_unit) {
    std::string text;
    for (std::size_t i = 0; i < measurements.size(); ++i) {
        Measurement shown = measurements[i];
        while (!shown.value && i + 1 < measurements.size() && !measurements[i + 1].value &&
               measurements[i + 1].reason == shown.reason) {
            shown.name += ", " + measurements[++i].name;
        }
        text += words(shown, time_unit);
    }
    return text;
}

std::string words(const Session& session, const Results& results) {
    std::string text = fmt::format(
        "{}: {}{}\n", session.outputs.front().string(), counted(results.frames, "frame"),
        results.identity.is_field()
            ? ""
            : fmt::format(", {} particles per frame", mean_text(results.particles_mean)));
    for (const ObservableResult& observable : results.observables) {
        const std::string name =
            observable.name == "q4" ? report::order_symbol(results) : observable.name;
        text += fmt::format("  {} ({})\n", name, format_duration(observable.seconds));
        if (!observable.reason.empty()) text += fmt::format("    - ({})\n", observable.reason);
        text += words(observable.measurements, results.source.time_unit);
    }
    for (const PlannedStage& stage : session.plan.skipped()) {
        text += fmt::format("  skipped    {}: {}\n", stage.stage, stage.reason);
    }
    return text;
}

ordered_json facts(const Results& results) {
    ordered_json facts;
    facts["frames"] = results.frames;
    if (!results.identity.is_field()) facts["particles_mean"] = results.particles_mean;
    for (const ObservableResult& observable : results.observables) {
        facts[observable.name] = to_json(observable);
    }
    return facts;
}

}  // namespace

std::string AnalyzeCommand::purpose() const {
    return "measure order, phases, motion and density fluctuations";
}

Command::Inputs AnalyzeCommand::inputs() const {
    return {.placeholder = "TRACKS.h5|POINTS.csv|FIELD.h5",
            .meaning = "a trajectory, a table of points of any tracker, or a field file",
            .count = Count::many};
}

std::vector<OptionTable> AnalyzeCommand::options() {
    OptionTable own("");
    own.text("output", output_, "results file to write");
    own.text(
        "label", job_.label,
        "name in plots; by default origin and control parameter if known, else the input's name");
    own.number("gamma", job_.adjustment.acceleration, "-", {0, 1e6},
               "acceleration of the vibration, A omega^2/g; auto: as the simulation says");
    own.numbers("box", box_, "", {1e-12, 1e12}, "box of the points as LX,LY in their length unit",
                {2, 2});
    own.choice("boundary", boundary_,
               {{"as-in-file", BoundaryChoice::as_in_file},
                {"periodic", BoundaryChoice::periodic},
                {"walls", BoundaryChoice::walls}},
               "what the sides of the box are");
    own.text("wavevectors", wavevectors_,
             "table kx,ky of wavevectors in 1/a at which S(k) is measured besides its grid");
    own.text("frames", job_.frames,
             "which snapshots, counted from 0, as FIRST:END:STEP; '100:' leaves out the first 100");
    own.number("fps", job_.adjustment.frame_rate, "1/s", {1e-9, 1e9},
               "frame rate; auto: as the file says");
    own.number("sphere-diameter", job_.adjustment.particle_diameter, "length unit of the file",
               {1e-9, 1e9},
               "true diameter a of a particle, the unit of the results; auto: as the file says");
    own.also_called("diameter");
    own.flag("from-fields", from_fields_,
             "of a field file: measure the stored fields, not what the run accumulated");
    own.flag(
        "partial", is_partial_,
        "of a part of a film: write what 'analyze --merge' merges; not what follows particles");
    own.affects(Effect::call);
    own.flag("merge", is_merge_,
             "the inputs are outputs of 'analyze --partial', of all parts of a film");
    own.affects(Effect::call);
    std::vector<OptionTable> tables{own};
    for (OptionTable& table : analysis::describe(job_.analysis)) tables.push_back(std::move(table));
    return tables;
}

std::string AnalyzeCommand::advice_on(std::string_view unknown_option) const {
    constexpr std::array<std::string_view, 12> of_snapshots{
        "skip", "discard", "first", "last", "first-frame", "last-frame",
        "from", "to",      "start", "stop", "every",       "stride"};
    if (std::ranges::find(of_snapshots, unknown_option) != of_snapshots.end()) {
        return "give '--frames FIRST:END:STEP': 100: leaves out the first 100 snapshots";
    }
    return {};
}

pipelines::AnalyzeJobOptions AnalyzeCommand::job() const {
    pipelines::AnalyzeJobOptions job = job_;
    job.output = output_;
    job.wavevectors = wavevectors_;
    job.fields =
        from_fields_ ? pipelines::FieldSamples::stored : pipelines::FieldSamples::accumulated;
    if (!box_.empty()) job.adjustment.box_length = Vec2{box_[0], box_[1]};
    if (boundary_ == BoundaryChoice::periodic) job.adjustment.boundary = Boundary::periodic;
    if (boundary_ == BoundaryChoice::walls) job.adjustment.boundary = Boundary::walls;
    return job;
}

void AnalyzeCommand::require_inputs(const Session& session) const {
    const auto refuse = [](std::string problem, std::string expected) {
        throw OptionError({.problem = std::move(problem),
                           .actual = {},
                           .expected = std::move(expected),
                           .suggestion = {}});
    };
    if (is_partial_ && is_merge_) {
        refuse("option 'partial' and option 'merge' exclude each other", "one of them");
    }
    if (!is_merge_ && session.inputs.size() > 1) {
        refuse(fmt::format("'analyze' got {} inputs", session.inputs.size()),
               "one input, or option 'merge'");
    }
    if ((is_merge_ || is_partial_) && session.common.explain) {
        refuse("parts of an analysis have no plan to explain", "no option 'explain'");
    }
}

std::vector<std::string> AnalyzeCommand::usual() const {
    return {"output",   "frames",      "fps",        "sphere-diameter", "box",
            "boundary", "observables", "neighbours", "largest",         "threads"};
}

std::string AnalyzeCommand::default_output(const std::vector<std::filesystem::path>& inputs) const {
    return named_after(inputs, is_partial_ ? ".acc" : "-results.h5");
}

Summary AnalyzeCommand::run(Session& session) {
    return pipelines::run_or_discard("analysis", output_, [&]() -> Summary {
        require_output(session, output_);
        require_inputs(session);
        if (is_partial_) {
            const pipelines::PartJobResult part = pipelines::analyze_part(job(), session);
            std::string names;
            for (const std::string& name : part.observables) {
                names += (names.empty() ? "" : ", ") + name;
            }
            return {.text = fmt::format("{}: {} of {}, of {} of the film\n", output_, names,
                                        counted(part.frames, "frame"), part.whole),
                    .facts = {{"observables", part.observables},
                              {"frames", part.frames},
                              {"first", part.first},
                              {"film_frames", part.whole}},
                    .signal = 0};
        }
        require_hdf5_name(output_);
        if (is_merge_) {
            const Results results = pipelines::merge_parts(job(), session);
            return {.text = words(session, results), .facts = facts(results), .signal = 0};
        }
        if (session.common.explain) {
            pipelines::plan_analysis(job(), session);
            return explanation(session.plan);
        }
        const Results results = pipelines::run_analysis(job(), session);
        return {.text = words(session, results), .facts = facts(results), .signal = 0};
    });
}

}  // namespace grainfield::app
