#include "app/critical_command.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>

#include <fmt/format.h>

#include "analysis/spectra/fit_result.h"
#include "app/interrupt_deadline.h"
#include "core/errors.h"
#include "core/support/interrupt.h"
#include "io/h5/results_file.h"
#include "report/page/text.h"

namespace grainfield::app {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

std::optional<double> number_in(std::string text) {
    text.erase(0, text.find_first_not_of(" \t"));
    text.erase(text.find_last_not_of(" \t") + 1);
    double value = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (problem != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return std::isfinite(value) ? std::optional<double>(value) : std::nullopt;
}

// The value of an option in the record of the run or of what it was made from.
std::optional<double> recorded_value(const Results& results, const std::string& option) {
    std::vector<const RunRecord*> records{&results.record};
    for (const RunRecord& record : results.sources) records.push_back(&record);
    for (const RunRecord* record : records) {
        for (const auto& [name, text] : record->configuration) {
            if (name == option) return number_in(text);
        }
    }
    return std::nullopt;
}

// The recorded option that ends in the same word, or else the nearest name.
std::string did_you_mean(const Results& results, const std::string& option) {
    std::vector<std::string> names;
    for (const RunRecord& record : results.sources) {
        for (const auto& [name, text] : record.configuration) {
            if (number_in(text)) names.push_back(name);
            if (name.ends_with("." + option)) return fmt::format("did you mean {}?", name);
        }
    }
    const std::string nearest = nearest_name(option, names);
    return nearest.empty() ? "give --values instead" : fmt::format("did you mean {}?", nearest);
}

// The control parameter that every run names, if all of them name the same one.
std::optional<ControlParameter> common_parameter(const std::vector<Results>& results) {
    std::optional<ControlParameter> common;
    for (const Results& run : results) {
        if (!run.identity.control) return std::nullopt;
        const ControlParameter own = run.identity.control->parameter;
        if (common && *common != own) return std::nullopt;
        common = own;
    }
    return common;
}

// The series of which all runs are; its origin is `points` where they are of several.
RunIdentity critical_identity(const std::vector<Results>& results) {
    RunIdentity identity = results.front().identity;
    for (const Results& run : results) {
        if (!same_series(run.identity, identity)) identity = {};
    }
    identity.control = std::nullopt;
    identity.role = RunRole::critical_point;
    return identity;
}

// S0/S1 means something only where S grows with k: by more than the error of S1, else the ratio may
// be anything.
constexpr const char* no_rise =
    "S does not grow with k in its range: S1 is not positive, or below its error";

bool rises(double s1, double error) {
    return s1 > 0 && s1 > error;
}

struct Gathered {
    std::vector<analysis::CriticalPoint> points;
    std::optional<Measurement> alpha;
};

// S0/S1 as each run gives it; runs without are left out with a warning.
Gathered as_fitted(const std::vector<Results>& results, const std::vector<double>& x,
                   RunPlan& plan) {
    Gathered gathered;
    for (std::size_t i = 0; i < results.size(); ++i) {
        const ObservableResult* fit = results[i].find("fit");
        const Measurement* m = fit == nullptr ? nullptr : fit->find_measurement("s0_over_s1");
        const Measurement* s1 = fit == nullptr ? nullptr : fit->find_measurement("s1");
        const bool falls = s1 != nullptr && s1->value && !rises(*s1->value, s1->error.value_or(0));
        if (m != nullptr && m->value && m->error && !falls) {
            gathered.points.push_back({x[i], *m->value, *m->error});
            continue;
        }
        const std::string why = falls            ? no_rise
                                : fit == nullptr ? "it has no fit; analyse it again (a density "
                                                   "field with --fit-k-max)"
                                : !fit->reason.empty()     ? fit->reason
                                : m != nullptr && m->value ? "S0/S1 has no error"
                                                           : "it has no S0/S1";
        plan.warn(fmt::format("'{}' is left out: {}", results[i].label, why));
    }
    return gathered;
}

// All spectra fitted again with one exponent.
Gathered with_shared_exponent(const std::vector<Results>& results, const std::vector<double>& x,
                              RunPlan& plan) {
    std::vector<analysis::Spectrum> spectra;
    std::vector<double> k_max;
    for (const Results& run : results) {
        const ObservableResult* sk = run.find("sk");
        const ObservableResult* fit = run.find("fit");
        spectra.push_back(sk == nullptr || fit == nullptr
                              ? analysis::Spectrum{}
                              : analysis::recorded_spectrum(*sk, analysis::recorded_modes(*fit)));
        const Measurement* end = fit == nullptr ? nullptr : fit->find_measurement("k_fit");
        k_max.push_back(end != nullptr && end->value ? *end->value : 0);
    }
    Gathered gathered;
    const auto fits = analysis::fit_shared(spectra, k_max);
    for (std::size_t i = 0; i < fits.size(); ++i) {
        if (!fits[i].ok()) {
            plan.warn(fmt::format("'{}' is left out: {}", results[i].label, fits[i].reason));
            continue;
        }
        if (!rises(fits[i].s1, fits[i].error[1])) {
            plan.warn(fmt::format("'{}' is left out: {}", results[i].label, no_rise));
            continue;
        }
        gathered.points.push_back({x[i], fits[i].ratio(), fits[i].ratio_error()});
        gathered.alpha = Measurement{"alpha",
                                     "-",
                                     fits[i].alpha,
                                     fits[i].error[2],
                                     static_cast<double>(gathered.points.size()),
                                     "shared by all runs; errors from the likelihood"};
    }
    return gathered;
}

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
    own.text("output", output_, "results file to write");
    own.text("values", values_, "control parameter of each input, as V1,V2,… in their order");
    own.text("parameter", parameter_,
             "name of the control parameter; without --values an option that the inputs record; by "
             "default Γ or ν as the inputs say");
    own.text("label", label_, "name in plots");
    own.choice("line", line_,
               {{"free", analysis::CriticalLine::free},
                {"through-zero", analysis::CriticalLine::through_zero}},
               "free intercept, or held to zero at zero (the parameter is then a distance)");
    own.choice("exponent", exponent_,
               {{"as-fitted", Exponent::as_fitted}, {"shared", Exponent::shared}},
               "S0/S1 as the inputs give it, or all fitted again with one exponent");
    return {own};
}

std::vector<double> CriticalCommand::control_values(const Session& session,
                                                    const std::vector<Results>& results) const {
    std::vector<double> values;
    if (values_.empty()) {
        if (parameter_.empty() && common_parameter(results)) {
            for (const Results& run : results) values.push_back(run.identity.control->value);
            return values;
        }
        if (parameter_.empty()) {
            throw OptionError(
                {.problem = "the control parameter of the inputs is not known",
                 .actual = "neither --values nor --parameter",
                 .expected = "one of them",
                 .suggestion = "--values 4.5,4.8,… or --parameter vibration.amplitude"});
        }
        for (std::size_t i = 0; i < results.size(); ++i) {
            const auto value = recorded_value(results[i], parameter_);
            if (!value) {
                throw OptionError({.problem = fmt::format("'{}' records no number '{}'",
                                                          session.inputs[i].string(), parameter_),
                                   .actual = {},
                                   .expected = "an option of the run with its section, such as "
                                               "vibration.amplitude or model.nu",
                                   .suggestion = did_you_mean(results[i], parameter_)});
            }
            values.push_back(*value);
        }
        return values;
    }
    std::istringstream entries(values_);
    for (std::string entry; std::getline(entries, entry, ',');) {
        const auto value = number_in(entry);
        if (!value) {
            throw OptionError({.problem = "--values holds something that is not a number",
                               .actual = "'" + entry + "'",
                               .expected = "numbers with commas between them",
                               .suggestion = {}});
        }
        values.push_back(*value);
    }
    if (values.size() != results.size()) {
        throw OptionError({.problem = "--values does not fit the inputs",
                           .actual = fmt::format("{} numbers", values.size()),
                           .expected = fmt::format("{}, one for each input", results.size()),
                           .suggestion = {}});
    }
    return values;
}

std::string CriticalCommand::parameter_text(const std::vector<Results>& results) const {
    if (!parameter_.empty()) return parameter_;
    const auto known = common_parameter(results);
    return values_.empty() && known ? symbol(*known) : "control parameter";
}

Summary CriticalCommand::run(Session& session) {
    return run_or_discard("critical", output_, [&] { return work(session); });
}

Summary CriticalCommand::work(Session& session) const {
    require_output(session, output_);
    require_hdf5_name(output_);
    session.plan.run("line", fmt::format("through S0/S1 of {} results", session.inputs.size()));
    if (session.common.explain) return explanation(session.plan);
    std::vector<Results> results;
    for (const fs::path& input : session.inputs) {
        throw_if_interrupted("critical");
        results.push_back(io::read_results(input));
    }
    const std::vector<double> x = control_values(session, results);
    const Gathered gathered = exponent_ == Exponent::shared
                                  ? with_shared_exponent(results, x, session.plan)
                                  : as_fitted(results, x, session.plan);
    if (gathered.points.empty()) {
        throw InputError({.problem = "none of the inputs has an S0/S1",
                          .actual = counted(static_cast<std::int64_t>(results.size()), "input"),
                          .expected = "results with a fit of S0 + S1 (ka)^alpha, S1 positive",
                          .suggestion = "see the warnings; 'analyze --fit-k-max' sets the range"});
    }
    const std::string parameter = parameter_text(results);
    Results out;
    out.identity = critical_identity(results);
    out.label = label_;
    out.box = results.front().box;
    out.source.source = "results";
    out.observables = {
        analysis::critical_result(gathered.points, line_, parameter, gathered.alpha)};
    out.record = session.record();
    const auto overwrite = session.common.force ? io::Overwrite::force : io::Overwrite::refuse;
    io::write_results(output_, out, overwrite);
    session.outputs.push_back(output_);

    Summary summary;
    const ObservableResult& critical = out.observables.front();
    summary.text = words(session, critical, gathered.points.size());
    summary.facts["runs"] = gathered.points.size();
    for (const Measurement& m : critical.measurements) {
        ordered_json& object = summary.facts[m.name];
        if (m.value) object["value"] = *m.value;
        if (m.error) object["error"] = *m.error;
        object["samples"] = m.samples;
        if (!m.reason.empty()) object["reason"] = m.reason;
    }
    if (!critical.reason.empty()) summary.facts["reason"] = critical.reason;
    return summary;
}

}  // namespace grainfield::app
