#include "app/simulate_field_command.h"

#include <charconv>
#include <filesystem>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/progress.h"
#include "pipelines/field/field_job.h"

namespace grainfield::app {

namespace {

using nlohmann::ordered_json;

std::vector<double> parse_list(const std::string& text) {
    std::vector<double> values;
    const char* next = text.data();
    const char* end = next + text.size();
    while (next != end) {
        double value = 0;
        const auto [stop, error] = std::from_chars(next, end, value);
        if (error != std::errc() || !(value >= 0) || (stop != end && *stop != ',')) {
            throw OptionError({.problem = "option 'nu-list' has a wrong value",
                               .actual = fmt::format("'{}'", text),
                               .expected = "numbers between commas",
                               .suggestion = "for example 0.005,0.001"});
        }
        values.push_back(value);
        next = stop == end ? end : stop + 1;
    }
    return values;
}

std::filesystem::path name_for(const std::filesystem::path& output, double nu) {
    return output.parent_path() /
           fmt::format("{}-nu{:g}{}", output.stem().string(), nu, output.extension().string());
}

std::string words(const std::filesystem::path& output, const pipelines::FieldJobResult& result) {
    std::string text = fmt::format("{}: {} steps, {:.3f} ms each, scheme {}\n", output.string(),
                                   result.steps, result.ms_per_step, result.scheme);
    for (const ObservableResult& observable : result.statistics) {
        for (const Measurement& m : observable.measurements) {
            if (!m.value) continue;
            text += fmt::format("  {:<22} {:.5g}", m.name, *m.value);
            if (m.error) text += fmt::format(" ± {:.2g}", *m.error);
            text += "\n";
        }
    }
    return text + fmt::format("  {:<22} {:.2g} standard deviations of a cell\n", "mass drift",
                              result.mass_drift);
}

ordered_json facts(const pipelines::FieldJobResult& result) {
    ordered_json facts;
    facts["steps"] = result.steps;
    facts["ms_per_step"] = result.ms_per_step;
    facts["mass_drift"] = result.mass_drift;
    facts["scheme"] = result.scheme;
    facts["memory_mb"] = result.memory_mb;
    return facts;
}

}  // namespace

std::string SimulateFieldCommand::purpose() const {
    return "simulate the order and density fields of the continuum model";
}

std::vector<OptionTable> SimulateFieldCommand::options() {
    OptionTable own("");
    own.text("output", output_, "field file to write");
    own.flag("resume", resume_, "go on from the checkpoint of an interrupted run");
    own.number("checkpoint-every", checkpoint_every_, "s", {0.01, 1e9},
               "wall time between checkpoints");
    own.text("nu-list", nu_list_, "values of nu, one output each, as 0.005,0.001");
    OptionTable sk("sk");
    sk.number("k-max", sk_.k_max, "1/l", {1e-9, 1e9}, "largest wavevector of S(k)");
    std::vector<OptionTable> tables{own, sk};
    for (OptionTable& table : simulate::describe(field_)) tables.push_back(std::move(table));
    return tables;
}

Summary SimulateFieldCommand::run(Session& session) {
    require_output(session, output_);
    require_hdf5_name(output_);
    field_.seed = static_cast<std::uint64_t>(session.common.seed);
    field_.threads = session.threads();
    const std::vector<double> list = parse_list(nu_list_);
    std::vector<pipelines::FieldJobOptions> jobs;
    for (const double nu : list.empty() ? std::vector<double>{field_.model.nu} : list) {
        pipelines::FieldJobOptions job{output_, resume_, checkpoint_every_, field_, sk_};
        job.field.model.nu = nu;
        if (!list.empty()) job.output = name_for(output_, nu);
        for (const pipelines::FieldJobOptions& other : jobs) {
            if (other.output != job.output) continue;
            throw OptionError({.problem = "option 'nu-list' has two values with one output",
                               .actual = fmt::format("{:g} and {:g}, both '{}'",
                                                     other.field.model.nu, nu, job.output.string()),
                               .expected = "values that differ in six digits",
                               .suggestion = "leave one of them out"});
        }
        jobs.push_back(std::move(job));
    }
    Summary summary;
    for (std::size_t i = 0; i < jobs.size(); ++i) {
        RunPlan plan;
        const simulate::FieldPlan field = simulate::plan_field(jobs[i].field, plan);
        if (i == 0) session.plan = plan;
        for (const Warning& warning : plan.warnings()) session.plan.warn(warning);
        if (session.common.explain) return explanation(session.plan);
        // What --resume finds finished is left as it is.
        if (resume_ && jobs.size() > 1 && std::filesystem::exists(jobs[i].output)) continue;
        // Each output records its own ν.
        for (auto& [name, text] : session.configuration) {
            if (name == "model.nu") text = to_text(OptionValue(jobs[i].field.model.nu));
        }
        const pipelines::FieldJobResult result = pipelines::run_field_job(jobs[i], field, session);
        summary.text += words(jobs[i].output, result);
        if (jobs.size() == 1) {
            summary.facts = facts(result);
        } else {
            ordered_json entry = facts(result);
            entry["nu"] = jobs[i].field.model.nu;
            summary.facts["runs"].push_back(std::move(entry));
        }
        summary.signal = result.signal;
        if (result.signal != 0) break;
    }
    for (const PlannedStage& stage : session.plan.skipped()) {
        summary.text += fmt::format("  skipped    {}: {}\n", stage.stage, stage.reason);
    }
    return summary;
}

}  // namespace grainfield::app
