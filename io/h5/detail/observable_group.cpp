#include "io/h5/detail/observable_group.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "io/h5/detail/run_record_json.h"

namespace grainfield::io {

namespace {

using nlohmann::json;

// A name for a child of `group` that says what `wanted` says and is free.
std::string free_name(const H5Group& group, std::string wanted) {
    constexpr std::string_view plain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
    for (char& c : wanted) {
        if (plain.find(c) == std::string_view::npos) c = '_';
    }
    if (wanted.empty()) wanted.push_back('_');
    std::string name = wanted;
    for (int i = 2; group.has(name); ++i) name = fmt::format("{}_{}", wanted, i);
    return name;
}

json write_curve(const H5Group& group, const Curve& curve) {
    const std::string name = free_name(group, curve.name);
    const H5Group own = group.make_group(name);
    json columns = json::array();
    for (const Column& column : curve.columns) {
        const std::string data = free_name(own, column.name);
        own.write<double>(data, column.values, {column.values.size()});
        columns.push_back({{"name", column.name},
                           {"unit", column.unit.text()},
                           {"meaning", column.meaning},
                           {"data", data}});
    }
    return {{"name", curve.name},
            {"title", curve.title},
            {"data", name},
            {"columns", columns},
            {"text_columns", curve.text_columns}};
}

Curve read_curve(const H5Group& group, const json& text) {
    Curve curve;
    curve.name = text.at("name").get<std::string>();
    curve.title = text.at("title").get<std::string>();
    const H5Group own = group.group(text.at("data").get<std::string>());
    for (const json& entry : text.at("columns")) {
        Column column{.name = entry.at("name").get<std::string>(),
                      .unit = entry.at("unit").get<std::string>(),
                      .meaning = entry.at("meaning").get<std::string>(),
                      .values = own.dataset(entry.at("data").get<std::string>()).read<double>()};
        curve.columns.push_back(std::move(column));
    }
    curve.text_columns =
        text.at("text_columns").get<std::map<std::string, std::vector<std::string>>>();
    return curve;
}

// The length that a column has and the first one does not, if any.
bool is_rectangular(const Curve& curve) {
    const std::size_t rows = curve.columns.empty() ? 0 : curve.columns.front().values.size();
    return std::ranges::all_of(curve.columns,
                               [rows](const Column& c) { return c.values.size() == rows; }) &&
           (curve.columns.empty() || std::ranges::all_of(curve.text_columns, [rows](const auto& c) {
                return c.second.size() == rows;
            }));
}

json to_json(const Measurement& m) {
    return {{"name", m.name},
            {"unit", m.unit.text()},
            {"value", io::to_json(m.value)},
            {"error", io::to_json(m.error)},
            {"samples", io::to_json(m.samples)},
            {"reason", m.reason}};
}

Measurement measurement_from_json(const json& text) {
    return {.name = text.at("name").get<std::string>(),
            .unit = text.at("unit").get<std::string>(),
            .value = optional_from_json(text.at("value")),
            .error = optional_from_json(text.at("error")),
            .samples = number_from_json(text.at("samples")),
            .reason = text.at("reason").get<std::string>()};
}

json to_json(const std::pair<std::string, OptionValue>& option) {
    const auto& [name, value] = option;
    if (const bool* flag = std::get_if<bool>(&value)) return {name, "flag", *flag};
    if (const auto* n = std::get_if<std::int64_t>(&value)) return {name, "integer", *n};
    if (const double* x = std::get_if<double>(&value)) return {name, "number", io::to_json(*x)};
    return {name, "text", std::get<std::string>(value)};
}

std::pair<std::string, OptionValue> option_from_json(const json& text) {
    const auto name = text.at(0).get<std::string>();
    const auto kind = text.at(1).get<std::string>();
    const json& value = text.at(2);
    if (kind == "flag") return {name, value.get<bool>()};
    if (kind == "integer") return {name, whole_from_json<std::int64_t>(value)};
    if (kind == "number") return {name, number_from_json(value)};
    return {name, value.get<std::string>()};
}

json write_observable(const H5Group& curves, const ObservableResult& result) {
    const std::string name = free_name(curves, result.name);
    const H5Group own = curves.make_group(name);
    json text{{"name", result.name},
              {"reason", result.reason},
              {"seconds", io::to_json(result.seconds)},
              {"data", name},
              {"measurements", json::array()},
              {"options", json::array()},
              {"curves", json::array()}};
    for (const Measurement& m : result.measurements) text["measurements"].push_back(to_json(m));
    for (const auto& option : result.options) text["options"].push_back(to_json(option));
    for (const Curve& curve : result.curves) text["curves"].push_back(write_curve(own, curve));
    return text;
}

ObservableResult read_observable(const H5Group& curves, const json& text) {
    ObservableResult result;
    result.name = text.at("name").get<std::string>();
    result.reason = text.at("reason").get<std::string>();
    result.seconds = number_from_json(text.at("seconds"));
    for (const json& m : text.at("measurements")) {
        result.measurements.push_back(measurement_from_json(m));
    }
    for (const json& option : text.at("options")) {
        result.options.push_back(option_from_json(option));
    }
    const H5Group own = curves.group(text.at("data").get<std::string>());
    for (const json& curve : text.at("curves")) {
        result.curves.push_back(read_curve(own, curve));
        if (!is_rectangular(result.curves.back())) {
            curves.file().fail(fmt::format("the columns of curve '{}' have different lengths",
                                           result.curves.back().name));
        }
    }
    return result;
}

}  // namespace

json write_observables(const H5Group& curves, const std::vector<ObservableResult>& observables) {
    json list = json::array();
    for (const ObservableResult& observable : observables) {
        list.push_back(write_observable(curves, observable));
    }
    return list;
}

std::vector<ObservableResult> read_observables(const H5Group& curves, const json& text) {
    std::vector<ObservableResult> observables;
    for (const json& observable : text) observables.push_back(read_observable(curves, observable));
    return observables;
}

void require_rectangular(const std::vector<ObservableResult>& observables, const H5File& file) {
    for (const ObservableResult& observable : observables) {
        for (const Curve& curve : observable.curves) {
            if (is_rectangular(curve)) continue;
            file.fail(fmt::format("the columns of curve '{}' have different lengths", curve.name));
        }
    }
}

}  // namespace grainfield::io
