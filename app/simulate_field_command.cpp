#include "app/simulate_field_command.h"

#include <chrono>
#include <filesystem>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/progress.h"
#include "pipelines/configuration.h"

namespace grainfield::app {

namespace {

using nlohmann::ordered_json;

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

// The session's job for one value of nu, which its output records: `critical` looks there. The
// record is that of a run of this nu alone, so that a list that is gone on with may be longer.
pipelines::Job job_of(const Session& session, const pipelines::FieldJobOptions& options) {
    pipelines::Job job = session;
    job.outputs.clear();
    job.plan = RunPlan(session.plan.wording());
    simulate::FieldOptions field = options.field;
    pipelines::update(job.configuration, simulate::describe(field));
    for (auto& [name, value] : job.configuration) {
        if (name == "output") value = options.output.string();
        if (name == "nu-list") value = "";
    }
    return job;
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
    own.flag("resume", job_.resume.resume,
             "go on from the checkpoint of an interrupted run if it is there");
    own.affects(Effect::call);  // a run that was gone on with is recorded as one
    own.number("checkpoint-every", checkpoint_every_, "s", {0.01, 1e9},
               "wall time between checkpoints");
    own.affects(Effect::work);
    own.numbers("nu-list", nu_list_, "-", {.minimum = 0},
                "values of nu, one output each, as 0.005,0.001");
    OptionTable sk("sk");
    sk.number("k-max", job_.sk.k_max, "1/l", {1e-9, 1e9}, "largest wavevector of S(k)");
    std::vector<OptionTable> tables{own, sk};
    for (OptionTable& table : simulate::describe(job_.field)) tables.push_back(std::move(table));
    return tables;
}

std::vector<pipelines::FieldJobOptions> SimulateFieldCommand::jobs() const {
    std::vector<pipelines::FieldJobOptions> jobs;
    for (const double nu : nu_list_.empty() ? std::vector<double>{job_.field.model.nu} : nu_list_) {
        pipelines::FieldJobOptions job = job_;
        job.output = nu_list_.empty() ? std::filesystem::path(output_) : name_for(output_, nu);
        job.resume.every = std::chrono::duration<double>(checkpoint_every_);
        job.field.model.nu = nu;
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
    return jobs;
}

std::vector<std::string> SimulateFieldCommand::usual() const {
    return {"output", "nu", "b", "dimension", "nx", "ny", "relax", "record", "replicas", "resume"};
}

std::string SimulateFieldCommand::default_output(
    const std::vector<std::filesystem::path>& /*inputs*/) const {
    return "field.h5";
}

Summary SimulateFieldCommand::run(Session& session) {
    require_output(session, output_);
    require_hdf5_name(output_);
    job_.field.seed = session.seed;
    job_.field.threads = session.threads;
    const std::vector<pipelines::FieldJobOptions> jobs = this->jobs();
    if (session.common.explain) {
        pipelines::plan_field(jobs.front(), session);
        return explanation(session.plan);
    }
    Summary summary;
    bool has_plan = false;  // that of the first job that runs
    for (const pipelines::FieldJobOptions& job : jobs) {
        pipelines::Job one = job_of(session, job);
        const auto take_over = [&] {
            if (!std::exchange(has_plan, true)) session.plan = one.plan;
            for (const Warning& warning : one.plan.warnings()) session.plan.warn(warning);
            std::ranges::copy(one.outputs, std::back_inserter(session.outputs));
        };
        pipelines::FieldJobResult result;
        try {
            result = pipelines::run_field(job, one);
        } catch (const pipelines::AlreadyComplete& complete) {
            if (jobs.size() == 1) throw;
            // Of a list, what an earlier run finished is left as it is.
            summary.text += fmt::format("{}\n", complete.what());
            summary.facts["runs"].push_back({{"nu", job.field.model.nu}, {"complete", true}});
            session.outputs.push_back(job.output);
            continue;
        } catch (...) {
            take_over();  // what was warned of before it failed is said
            throw;
        }
        take_over();
        summary.text += words(job.output, result);
        if (jobs.size() == 1) {
            summary.facts = facts(result);
            session.start = one.start;
        } else {
            ordered_json entry = facts(result);
            entry["nu"] = job.field.model.nu;
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
