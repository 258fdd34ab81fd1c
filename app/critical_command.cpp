#include "app/critical_command.h"

#include <optional>

#include <fmt/format.h>

#include "app/standard_output.h"
#include "core/errors.h"
#include "pipelines/interrupt_deadline.h"
#include "report/text.h"

namespace grainfield::app {

namespace {

using nlohmann::ordered_json;
using pipelines::SharedExponent;

std::string words(const Session& session, const ObservableResult& critical, std::size_t runs) {
    std::string text = fmt::format("{}: S0/S1 of {}\n", session.outputs.front().string(),
                                   counted(static_cast<std::int64_t>(runs), "run"));
    if (!critical.reason.empty()) text += fmt::format("  - ({})\n", critical.reason);
    for (const Measurement& m : critical.measurements) {
        text += fmt::format("  {:<16} ", m.name);
        if (m.value) text += report::with_error(*m.value, m.error ? &*m.error : nullptr);
        if (!m.reason.empty()) text += fmt::format("{}({})", m.value ? " " : "- ", m.reason);
        text += "\n";
    }
    return text;
}

}  // namespace

std::string CriticalCommand::purpose() const {
    return "find where S0/S1 vanishes as a control parameter changes";
}

Command::Inputs CriticalCommand::inputs() const {
    return {.placeholder = "RESULTS.h5...",
            .meaning = "results with a fit of S(k), one for each value of the control parameter",
            .count = Count::many};
}

std::vector<OptionTable> CriticalCommand::options() {
    OptionTable own("");
    own.text("output", output_, "results file to write; - prints JSON, as --json does");
    own.numbers("values", values_, "", {},
                "control parameter of each input, as V1,V2,… in their order");
    own.text("parameter", job_.parameter,
             "name of the control parameter; without --values an option that the inputs record; by "
             "default Γ or ν as the inputs say");
    own.text("label", job_.label, "name in plots");
    own.choice(
        "line", job_.line,
        {{"free", analysis::CriticalLine::free},
         {"through-zero", analysis::CriticalLine::through_zero},
         {"power", analysis::CriticalLine::power},
         {"power-and-constant", analysis::CriticalLine::power_and_constant}},
        "what goes through S0/S1: a line with a free intercept, or held to zero at zero (the "
        "parameter is then a distance); a power of the parameter, or a constant and a power");
    own.choice("exponent", job_.exponent,
               {{"as-fitted", SharedExponent::no}, {"shared", SharedExponent::yes}},
               "S0/S1 as the inputs give it, or all fitted again with one exponent");
    return {own};
}

std::string CriticalCommand::default_output(
    const std::vector<std::filesystem::path>& /*inputs*/) const {
    return "critical.h5";
}

Summary CriticalCommand::run(Session& session) {
    return pipelines::run_or_discard("critical", output_, [&] { return work(session); });
}

Summary CriticalCommand::work(Session& session) const {
    const bool is_printed = is_standard_output(output_);
    require_output(session, output_);
    if (!is_printed) require_hdf5_name(output_);
    session.plan.run("line", fmt::format("through S0/S1 of {} results", session.inputs.size()));
    if (session.common.explain) return explanation(session.plan);
    pipelines::CriticalJobOptions job = job_;
    std::optional<StandardOutputFile> printed;
    if (is_printed) printed.emplace("critical.h5");
    job.output = is_printed ? printed->path().string() : output_;
    job.values = values_;
    const auto [runs, critical] = pipelines::find_critical_point(job, session);
    if (is_printed) session.outputs.clear();

    Summary summary;
    if (pipelines::has_no_value(critical)) summary.code = ExitCode::bad_input;
    if (!is_printed) summary.text = words(session, critical, runs);
    summary.facts["runs"] = runs;
    for (const Measurement& m : critical.measurements) {
        ordered_json& object = summary.facts[m.name];
        if (m.value) object["value"] = *m.value;
        if (m.error) object["error"] = *m.error;
        object["samples"] = m.samples;
        if (!m.reason.empty()) object["reason"] = m.reason;
    }
    if (!critical.reason.empty()) summary.facts["reason"] = critical.reason;
    if (is_printed) {
        summary.is_table = true;
        summary.text = json_summary(session, summary)
                           .dump(2, ' ', false, ordered_json::error_handler_t::replace) +
                       "\n";
    }
    return summary;
}

}  // namespace grainfield::app
