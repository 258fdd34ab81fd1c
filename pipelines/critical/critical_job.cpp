#include "pipelines/critical/critical_job.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "analysis/spectra/fit_result.h"
#include "analysis/statistics/critical_result.h"
#include "core/errors.h"
#include "core/option_table.h"
#include "core/support/interrupt.h"
#include "io/h5/results_file.h"

namespace grainfield::pipelines {

namespace {

namespace fs = std::filesystem;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

std::optional<double> number_in(const std::string& text) {
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
    return nearest.empty() ? "give its values instead" : fmt::format("did you mean {}?", nearest);
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
        const double s1_error = s1 == nullptr ? unknown : s1->error.value_or(unknown);
        const bool falls = s1 != nullptr && s1->value && !analysis::rises(*s1->value, s1_error);
        if (m != nullptr && m->value && m->error && !falls) {
            gathered.points.push_back({x[i], *m->value, *m->error});
            continue;
        }
        const std::string why = falls            ? analysis::no_rise(*s1->value, s1_error)
                                : fit == nullptr ? "it has no fit; analyse it again (a density "
                                                   "field with a range of the fit)"
                                : !fit->reason.empty() ? fit->reason
                                : m == nullptr         ? "it has no S0/S1"
                                : m->value             ? "S0/S1 has no error"
                                                       : m->reason;
        plan.warn(fmt::format("'{}' is left out: {}", results[i].label, why));
    }
    return gathered;
}

// All spectra fitted again with one exponent.
Gathered with_shared_exponent(const std::vector<Results>& results, const std::vector<double>& x,
                              RunPlan& plan) {
    std::vector<analysis::Spectrum> spectra;
    std::vector<double> k_max;
    std::vector<std::string> without;  // why a run has no fit of its own; empty if it has
    for (const Results& run : results) {
        const ObservableResult* sk = run.find("sk");
        const ObservableResult* fit = run.find("fit");
        spectra.push_back(sk == nullptr || fit == nullptr
                              ? analysis::Spectrum{}
                              : analysis::recorded_spectrum(*sk, analysis::recorded_modes(*fit)));
        const Measurement* end = fit == nullptr ? nullptr : fit->find_measurement("k_fit");
        without.push_back(fit == nullptr ? "it has no fit" : analysis::why_no_fit(*fit));
        k_max.push_back(end != nullptr && end->value ? *end->value : 0);
    }
    Gathered gathered;
    const auto fits = analysis::fit_shared(spectra, k_max);
    for (std::size_t i = 0; i < fits.size(); ++i) {
        if (!fits[i].ok()) {
            plan.warn(fmt::format("'{}' is left out: {}", results[i].label,
                                  without[i].empty() ? fits[i].reason : without[i]));
            continue;
        }
        // By the error that the likelihood gives, as the weights of the points are.
        if (!analysis::rises(fits[i].s1, fits[i].error[1])) {
            plan.warn(fmt::format("'{}' is left out: {}", results[i].label,
                                  analysis::no_rise(fits[i].s1, fits[i].error[1])));
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

std::vector<double> control_values(const CriticalJobOptions& options,
                                   const std::vector<fs::path>& inputs,
                                   const std::vector<Results>& results) {
    if (!options.values.empty()) {
        if (options.values.size() == results.size()) return options.values;
        throw OptionError({.problem = "the values of the control parameter do not fit the inputs",
                           .actual = fmt::format("{} numbers", options.values.size()),
                           .expected = fmt::format("{}, one for each input", results.size()),
                           .suggestion = {}});
    }
    std::vector<double> values;
    if (options.parameter.empty() && common_parameter(results)) {
        for (const Results& run : results) values.push_back(run.identity.control->value);
        return values;
    }
    if (options.parameter.empty()) {
        throw OptionError({.problem = "the control parameter of the inputs is not known",
                           .actual = "neither its values nor its name",
                           .expected = "one of them",
                           .suggestion = "values 4.5,4.8,… or parameter vibration.amplitude"});
    }
    for (std::size_t i = 0; i < results.size(); ++i) {
        const auto value = recorded_value(results[i], options.parameter);
        if (!value) {
            throw OptionError({.problem = fmt::format("'{}' records no number '{}'",
                                                      inputs[i].string(), options.parameter),
                               .actual = {},
                               .expected = "an option of the run with its section, such as "
                                           "vibration.amplitude or model.nu",
                               .suggestion = did_you_mean(results[i], options.parameter)});
        }
        values.push_back(*value);
    }
    return values;
}

// One run counted twice would halve its error and fake a line.
void require_each_once(const std::vector<fs::path>& inputs) {
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            std::error_code error;
            if (!fs::equivalent(inputs[i], inputs[k], error)) continue;
            throw InputError({.problem = fmt::format("'{}' is given twice", inputs[i].string()),
                              .actual = fmt::format("inputs {} and {} are one file", k + 1, i + 1),
                              .expected = "one results file for each value of the parameter",
                              .suggestion = "leave one of them out"});
        }
    }
}

std::string parameter_text(const CriticalJobOptions& options, const std::vector<Results>& results) {
    if (!options.parameter.empty()) return options.parameter;
    const auto known = common_parameter(results);
    return options.values.empty() && known ? symbol(*known) : "control parameter";
}

// Why there is nothing but points, and what would help.
std::string no_value(const ObservableResult& critical, std::size_t points, std::size_t runs) {
    const char* advice =
        points < runs ? "the warnings say what the runs that are left out would need, or add runs"
                      : "add runs at other values of the control parameter";
    return fmt::format(
        "there is no critical value and no line: {}; {}. The output holds the "
        "points alone",
        critical.reason, advice);
}

}  // namespace

bool has_no_value(const ObservableResult& critical) {
    return critical.measurements.empty();
}

CriticalJobResult find_critical_point(const CriticalJobOptions& options, Job& job) {
    require_each_once(job.inputs);
    std::vector<Results> results;
    for (const fs::path& input : job.inputs) {
        throw_if_interrupted("critical");
        results.push_back(io::read_results(input));
    }
    const std::vector<double> x = control_values(options, job.inputs, results);
    const Gathered gathered = options.exponent == SharedExponent::yes
                                  ? with_shared_exponent(results, x, job.plan)
                                  : as_fitted(results, x, job.plan);
    if (gathered.points.empty()) {
        throw InputError(
            {.problem = "none of the inputs has an S0/S1",
             .actual = counted(static_cast<std::int64_t>(results.size()), "input"),
             .expected = "results with a fit of S0 + S1 (ka)^alpha, S1 positive",
             .suggestion = "see the warnings; --fit-k-max of analyze sets the range of the fit"});
    }
    Results out;
    // A copy: gcc 12 takes a moved one for uninitialized.
    const RunIdentity identity = critical_identity(results);
    out.identity = identity;
    out.label = options.label;
    out.box = results.front().box;
    out.source.source = "results";
    out.observables = {analysis::critical_result(gathered.points, options.line,
                                                 parameter_text(options, results), gathered.alpha)};
    if (has_no_value(out.observables.front())) {
        job.plan.warn(no_value(out.observables.front(), gathered.points.size(), results.size()));
    }
    out.record = job.record();
    io::write_results(options.output, out, job.overwrite);
    job.outputs.push_back(options.output);
    return {.runs = gathered.points.size(), .critical = out.observables.front()};
}

}  // namespace grainfield::pipelines
