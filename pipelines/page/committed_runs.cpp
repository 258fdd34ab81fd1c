#include "pipelines/page/committed_runs.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/origin_names.h"
#include "io/text/curve_csv.h"

namespace grainfield::pipelines {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view prefix = "gamma-";

// The value that the name of the folder of a run says.
std::optional<double> gamma_of(const fs::path& folder) {
    const std::string name = folder.filename().string();
    if (!name.starts_with(prefix)) return std::nullopt;
    double value = 0;
    const char* const last = name.data() + name.size();
    const auto [end, error] = std::from_chars(name.data() + prefix.size(), last, value);
    return error == std::errc() && end == last ? std::optional(value) : std::nullopt;
}

// The curves of an observable that are there. Wavevectors are in 1/a and windows in a.
ObservableResult observable(const fs::path& folder, const std::string& name,
                            const std::vector<std::string>& curves) {
    ObservableResult result;
    result.name = name;
    for (const std::string& curve : curves) {
        const fs::path file = folder / (curve + ".csv");
        std::error_code unreachable;
        if (!fs::exists(file, unreachable)) continue;
        result.curves.push_back(io::read_curve_csv(file));
        for (Column& column : result.curves.back().columns) {
            if (column.name == "k") column.unit = Unit("1/a");
            if (column.name == "l") column.unit = Unit("a");
        }
    }
    return result;
}

const std::vector<double>& values(const Curve& curve, const char* name, const fs::path& file) {
    if (const Column* column = curve.find(name)) return column->values;
    throw InputError({.problem = fmt::format("cannot read '{}'", file.string()),
                      .actual = fmt::format("no numbers in a column '{}'", name),
                      .expected = "the table of the committed runs",
                      .suggestion = {}});
}

// S1 with its error at that Γ.
std::optional<Measurement> slope_at(const fs::path& folder, double gamma) {
    const fs::path file = folder / "fits.csv";
    const Curve fits = io::read_curve_csv(file);
    const std::vector<double>& all = values(fits, "gamma", file);
    const auto row = static_cast<std::size_t>(std::ranges::find(all, gamma) - all.begin());
    if (row == all.size()) return std::nullopt;
    return Measurement{"s1", "-", values(fits, "s1", file)[row], values(fits, "s1_err", file)[row],
                       1,    ""};
}

// What made the runs, by the table of all.
Origin origin_in(const Curve& range, const fs::path& file) {
    const auto column = range.text_columns.find("origin");
    const std::vector<std::string> none;
    const std::vector<std::string>& words =
        column == range.text_columns.end() ? none : column->second;
    const auto origin = words.empty() ? std::nullopt : origin_called(words.front());
    const auto other = std::ranges::find_if(
        words, [&](const std::string& word) { return origin_called(word) != origin; });
    if (origin && other == words.end()) return *origin;
    std::string known;
    for (const auto& [value, name] : origin_names) {
        known += fmt::format("{}{}", known.empty() ? "" : ", ", name);
    }
    throw InputError(
        {.problem = fmt::format("what made the committed runs is not known: '{}'", file.string()),
         .actual = words.empty() ? std::string("no words in a column 'origin'")
                   : origin      ? fmt::format("origin '{}' and '{}'", words.front(), *other)
                                 : fmt::format("origin '{}'", words.front()),
         .expected = fmt::format("one of {}, the same in all rows", known),
         .suggestion = {}});
}

std::string label_of(const RunIdentity& identity) {
    return "committed " + legend_of(identity);
}

// S0/S1 against Γ, of the modes between walls.
Results ratios(const Curve& range, const fs::path& file, Origin origin) {
    const auto modes = range.text_columns.find("modes");
    Curve line{"critical", "", {}, {}};
    for (const auto& [from, to] :
         {std::pair("gamma", "x"), {"s0_over_s1", "s0_over_s1"}, {"err", "err"}}) {
        const std::vector<double>& all = values(range, from, file);
        Column column{
            to, "", std::string(to) == "x" ? symbol(ControlParameter::acceleration) : to, {}};
        for (std::size_t i = 0; i < all.size(); ++i) {
            const bool is_wanted = modes == range.text_columns.end() || modes->second[i] == "box";
            if (is_wanted) column.values.push_back(all[i]);
        }
        line.columns.push_back(std::move(column));
    }
    Results run;
    run.identity = {.origin = origin, .role = RunRole::critical_point};
    run.label = label_of(run.identity);
    ObservableResult critical;
    critical.name = "critical";
    critical.curves = {std::move(line)};
    run.observables = {std::move(critical)};
    return run;
}

}  // namespace

std::vector<Results> committed_runs(const fs::path& folder) {
    std::vector<std::pair<double, fs::path>> found;
    std::error_code unreachable;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, unreachable)) {
        if (const auto gamma = gamma_of(entry.path())) found.emplace_back(*gamma, entry.path());
    }
    if (found.empty()) {
        throw InputError({.problem = fmt::format("no committed runs in '{}'", folder.string()),
                          .actual = unreachable ? unreachable.message() : "no such folders",
                          .expected = "folders gamma-VALUE with curves as CSV",
                          .suggestion = "bench/results/paper holds those of the project"});
    }
    std::ranges::sort(found);
    const fs::path table = folder / "range.csv";
    const Curve range = io::read_curve_csv(table);
    const Origin origin = origin_in(range, table);
    std::vector<Results> runs;
    for (const auto& [gamma, path] : found) {
        Results run;
        run.identity = {.origin = origin,
                        .control = ControlValue{ControlParameter::acceleration, gamma}};
        run.label = label_of(run.identity);
        run.source.origin = origin;
        run.source.length_unit = LengthUnit::diameter;
        run.observables = {
            observable(path, "sk", {"sk", "sk_neumann"}),
            observable(path, "variance", {"variance", "variance_slope"}),
        };
        if (auto slope = slope_at(folder, gamma)) {
            ObservableResult fit;
            fit.name = "fit";
            fit.measurements = {*std::move(slope)};
            run.observables.push_back(std::move(fit));
        }
        runs.push_back(std::move(run));
    }
    runs.push_back(ratios(range, table, origin));
    return runs;
}

}  // namespace grainfield::pipelines
