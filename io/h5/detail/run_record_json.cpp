#include "io/h5/detail/run_record_json.h"

#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/origin_names.h"
#include "io/h5/detail/legacy_identity.h"

namespace grainfield::io {

namespace {

using nlohmann::json;

template <class Enum, std::size_t n>
using Names = std::array<std::pair<Enum, std::string_view>, n>;

constexpr Names<ControlParameter, 2> control_parameters{
    {{ControlParameter::acceleration, "acceleration"},
     {ControlParameter::critical_distance, "critical distance"}}};
constexpr Names<RunRole, 2> roles{
    {{RunRole::run, "run"}, {RunRole::critical_point, "critical point"}}};
constexpr Names<DiameterOrigin, 4> diameter_origins{{{DiameterOrigin::stated, "stated"},
                                                     {DiameterOrigin::simulated, "simulated"},
                                                     {DiameterOrigin::given, "given"},
                                                     {DiameterOrigin::apparent, "apparent"}}};
constexpr Names<WarningCode, 7> warning_codes{
    {{WarningCode::other, "other"},
     {WarningCode::apparent_diameter, "apparent diameter"},
     {WarningCode::incomplete, "incomplete"},
     {WarningCode::doubtful_heights, "doubtful heights"},
     {WarningCode::other_truth, "other truth"},
     {WarningCode::unscaled_errors, "unscaled errors"},
     {WarningCode::interrupted, "interrupted"}}};
constexpr Names<LengthUnit, 2> length_units{
    {{LengthUnit::pixel, "pixel"}, {LengthUnit::diameter, "diameter"}}};
constexpr Names<TimeUnit, 3> time_units{{{TimeUnit::frame, "frame"},
                                         {TimeUnit::second, "second"},
                                         {TimeUnit::sqrt_a_over_g, "sqrt(a/g)"}}};
constexpr Names<Boundary, 2> boundaries{
    {{Boundary::periodic, "periodic"}, {Boundary::walls, "walls"}}};

template <class Enum, std::size_t n>
json name_of(Enum value, const Names<Enum, n>& names) {
    for (const auto& [known, name] : names) {
        if (known == value) return json(name);
    }
    return nullptr;
}

template <class Enum, std::size_t n>
Enum value_of(const json& text, const Names<Enum, n>& names) {
    for (const auto& [known, name] : names) {
        if (text == name) return known;
    }
    throw json::other_error::create(501, "unknown word " + text.dump(), nullptr);
}

json pair_of(Vec2 v) {
    return json::array({to_json(v.x), to_json(v.y)});
}

Vec2 vec2_from_json(const json& text) {
    return {number_from_json(text.at(0)), number_from_json(text.at(1))};
}

json control_to_json(const std::optional<ControlValue>& control) {
    if (!control) return nullptr;
    return {{"parameter", name_of(control->parameter, control_parameters)},
            {"value", io::to_json(control->value)},
            {"unit", control->unit.text()}};
}

std::optional<ControlValue> control_from_json(const json& text) {
    if (text.is_null()) return std::nullopt;
    return ControlValue{.parameter = value_of(text.at("parameter"), control_parameters),
                        .value = number_from_json(text.at("value")),
                        .unit = text.at("unit").get<std::string>()};
}

// Texts and codes stand in two lists of one length: programs before the codes read the texts.
std::vector<Warning> warnings_from_json(const json& record) {
    std::vector<Warning> warnings;
    const json& texts = record.at("warnings");
    for (std::size_t i = 0; i < texts.size(); ++i) {
        const auto text = texts.at(i).get<std::string>();
        const WarningCode code = record.contains("warning_codes")
                                     ? value_of(record.at("warning_codes").at(i), warning_codes)
                                     : legacy_warning_code(text);
        warnings.push_back({code, text});
    }
    return warnings;
}

// Runs `read`, turning what nlohmann/json throws into an InputError.
template <class Read>
auto guarded(const std::string& file, const char* what, Read read) {
    try {
        return read();
    } catch (const json::exception& error) {
        throw InputError({.problem = fmt::format("cannot read '{}'", file),
                          .actual = fmt::format("{} is damaged ({})", what, error.what()),
                          .expected = {},
                          .suggestion = {}});
    }
}

}  // namespace

json to_json(double number) {
    if (std::isnan(number)) return "nan";
    if (std::isinf(number)) return number > 0 ? "inf" : "-inf";
    return number;
}

json to_json(const std::optional<double>& number) {
    return number ? to_json(*number) : json(nullptr);
}

double number_from_json(const json& text) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    if (text == "nan") return std::numeric_limits<double>::quiet_NaN();
    if (text == "inf") return infinity;
    if (text == "-inf") return -infinity;
    return text.get<double>();
}

std::optional<double> optional_from_json(const json& text) {
    if (text.is_null()) return std::nullopt;
    return number_from_json(text);
}

json to_json(const RunRecord& record) {
    json inputs = json::array();
    for (const RunRecord::Input& input : record.inputs) {
        inputs.push_back(
            {{"name", input.name}, {"bytes", input.bytes}, {"checksum", input.checksum}});
    }
    json configuration = json::array();
    for (const auto& [name, text] : record.configuration) {
        configuration.push_back(json::array({name, text}));
    }
    json warnings = json::array();
    json codes = json::array();
    for (const Warning& warning : record.warnings) {
        warnings.push_back(warning.text);
        codes.push_back(name_of(warning.code, warning_codes));
    }
    return {{"command", record.command},
            {"version", record.version},
            {"seed", record.seed},
            {"threads", record.threads},
            {"seconds", to_json(record.seconds)},
            {"configuration", configuration},
            {"inputs", inputs},
            {"skipped", record.skipped},
            {"warnings", warnings},
            {"warning_codes", codes}};
}

json to_json(const TrajectoryInfo& info) {
    return {{"origin", name_of(info.origin, origin_names)},
            {"length_unit", name_of(info.length_unit, length_units)},
            {"time_unit", name_of(info.time_unit, time_units)},
            {"diameter", to_json(info.diameter)},
            {"diameter_origin", name_of(info.diameter_origin, diameter_origins)},
            {"control", control_to_json(info.control)},
            {"vibration_frequency", to_json(info.vibration_frequency)},
            {"frame_rate", to_json(info.frame_rate)},
            {"source", info.source}};
}

json to_json(const RunIdentity& identity) {
    return {{"origin", name_of(identity.origin, origin_names)},
            {"role", name_of(identity.role, roles)},
            {"control", control_to_json(identity.control)},
            {"dimension", identity.dimension},
            {"gradient_order", to_json(identity.gradient_order)}};
}

json to_json(const Box& box) {
    return {
        {"origin", pair_of(box.origin)},
        {"length", pair_of(box.length)},
        {"boundary", {name_of(box.boundary[0], boundaries), name_of(box.boundary[1], boundaries)}},
        {"height", to_json(box.height)}};
}

RunRecord record_from_json(const json& text, const std::string& file) {
    return guarded(file, "the record of the run", [&] {
        RunRecord record;
        record.command = text.at("command").get<std::string>();
        record.version = text.at("version").get<std::string>();
        record.seed = whole_from_json<std::uint64_t>(text.at("seed"));
        record.threads = whole_from_json<int>(text.at("threads"));
        record.seconds = number_from_json(text.at("seconds"));
        for (const auto& entry : text.at("configuration")) {
            record.configuration.emplace_back(entry.at(0).get<std::string>(),
                                              entry.at(1).get<std::string>());
        }
        for (const auto& input : text.at("inputs")) {
            record.inputs.push_back({input.at("name").get<std::string>(),
                                     whole_from_json<std::uint64_t>(input.at("bytes")),
                                     input.at("checksum").get<std::string>()});
        }
        record.skipped = text.at("skipped").get<std::vector<std::string>>();
        record.warnings = warnings_from_json(text);
        return record;
    });
}

TrajectoryInfo info_from_json(const json& text, const std::string& file) {
    return guarded(file, "the description of the trajectory", [&] {
        TrajectoryInfo info;
        info.origin = value_of(text.at("origin"), origin_names);
        info.length_unit = value_of(text.at("length_unit"), length_units);
        info.time_unit = value_of(text.at("time_unit"), time_units);
        info.diameter = number_from_json(text.at("diameter"));
        if (names_identity(text)) {
            info.diameter_origin = value_of(text.at("diameter_origin"), diameter_origins);
            info.control = control_from_json(text.at("control"));
        }
        info.vibration_frequency = optional_from_json(text.at("vibration_frequency"));
        info.frame_rate = optional_from_json(text.at("frame_rate"));
        info.source = text.at("source").get<std::string>();
        return info;
    });
}

RunIdentity identity_from_json(const json& text, const std::string& file) {
    return guarded(file, "the identity of the run", [&] {
        RunIdentity identity;
        identity.origin = value_of(text.at("origin"), origin_names);
        identity.role = value_of(text.at("role"), roles);
        identity.control = control_from_json(text.at("control"));
        identity.dimension = whole_from_json<int>(text.at("dimension"));
        identity.gradient_order = optional_from_json(text.at("gradient_order"));
        return identity;
    });
}

Box box_from_json(const json& text, const std::string& file) {
    return guarded(file, "the box", [&] {
        Box box;
        box.origin = vec2_from_json(text.at("origin"));
        box.length = vec2_from_json(text.at("length"));
        box.boundary = {value_of(text.at("boundary").at(0), boundaries),
                        value_of(text.at("boundary").at(1), boundaries)};
        box.height = number_from_json(text.at("height"));
        return box;
    });
}

bool names_identity(const json& info) {
    return info.contains("control");
}

std::string text_of(const json& text) {
    return text.dump(-1, ' ', false, json::error_handler_t::replace);
}

json parse_json(const std::string& text, const std::string& file) {
    return guarded(file, "a JSON text", [&] { return json::parse(text); });
}

}  // namespace grainfield::io
