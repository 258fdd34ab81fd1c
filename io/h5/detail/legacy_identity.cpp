#include "io/h5/detail/legacy_identity.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace grainfield::io {

namespace {

const std::string* recorded(const RunRecord& record, const std::string& option) {
    for (const auto& [name, text] : record.configuration) {
        if (name == option) return &text;
    }
    return nullptr;
}

std::optional<double> number(const RunRecord& record, const std::string& option) {
    const std::string* text = recorded(record, option);
    if (text == nullptr) return std::nullopt;
    double value = 0;
    const auto [end, problem] = std::from_chars(text->data(), text->data() + text->size(), value);
    const bool whole = problem == std::errc() && end == text->data() + text->size();
    return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

const RunRecord* source_of(const Results& results, const std::string& command) {
    const auto found = std::ranges::find(results.sources, command, &RunRecord::command);
    return found == results.sources.end() ? nullptr : &*found;
}

std::optional<ControlValue> acceleration(const std::optional<double>& value) {
    if (!value) return std::nullopt;
    return ControlValue{.parameter = ControlParameter::acceleration, .value = *value};
}

// Γ = Aω²/g
std::optional<ControlValue> control_of_md(const RunRecord& md) {
    const auto amplitude = number(md, "vibration.amplitude");
    const auto omega = number(md, "vibration.angular-frequency");
    const double gravity = number(md, "cell.gravity").value_or(1);
    if (!amplitude || !omega || !(gravity > 0)) return std::nullopt;
    return acceleration(*amplitude * *omega * *omega / gravity);
}

bool was_given_diameter(const RunRecord& track) {
    const std::string* text = recorded(track, "track.sphere-diameter");
    return text != nullptr && *text != "auto" && !text->empty();
}

// The labels that workflow/Snakefile gave, which are series_text of what they name.
RunIdentity critical_identity(const std::string& label) {
    static const std::array<RunIdentity, 6> series{
        RunIdentity{.origin = Origin::video},
        RunIdentity{.origin = Origin::rendered},
        RunIdentity{.origin = Origin::md},
        RunIdentity{.origin = Origin::field, .gradient_order = 4},
        RunIdentity{.origin = Origin::field, .dimension = 1, .gradient_order = 2},
        RunIdentity{.origin = Origin::field, .dimension = 1, .gradient_order = 4}};
    const auto found = std::ranges::find(series, label, series_text);
    RunIdentity identity = found == series.end() ? RunIdentity{} : *found;
    identity.role = RunRole::critical_point;
    return identity;
}

}  // namespace

void add_legacy_identity(TrajectoryInfo& info, const RunRecord& record) {
    if (record.command == "simulate md") info.control = control_of_md(record);
    if (info.origin == Origin::md || info.origin == Origin::rendered) {
        info.diameter_origin = DiameterOrigin::simulated;
    }
    if (info.origin == Origin::video) {
        info.diameter_origin =
            was_given_diameter(record) ? DiameterOrigin::given : DiameterOrigin::apparent;
    }
}

RunIdentity legacy_field_identity(const RunRecord& field) {
    RunIdentity identity{.origin = Origin::field};
    identity.dimension = number(field, "lattice.dimension").value_or(2) == 1 ? 1 : 2;
    identity.gradient_order = number(field, "model.b");
    if (const auto nu = number(field, "model.nu")) {
        identity.control =
            ControlValue{.parameter = ControlParameter::critical_distance, .value = *nu};
    }
    return identity;
}

RunIdentity legacy_identity(const Results& results) {
    if (results.find("critical") != nullptr) return critical_identity(results.label);
    if (const RunRecord* field = source_of(results, "simulate field")) {
        return legacy_field_identity(*field);
    }
    RunIdentity identity{.origin = results.source.origin};
    identity.control = acceleration(number(results.record, "gamma"));
    const RunRecord* md = source_of(results, "simulate md");
    if (!identity.control && md != nullptr) identity.control = control_of_md(*md);
    return identity;
}

WarningCode legacy_warning_code(const std::string& text) {
    if (text.starts_with("lengths are in apparent disc diameters D")) {
        return WarningCode::apparent_diameter;
    }
    if (text.starts_with("interrupted")) return WarningCode::interrupted;
    return text.starts_with("incomplete") ? WarningCode::incomplete : WarningCode::other;
}

}  // namespace grainfield::io
