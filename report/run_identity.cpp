#include "report/run_identity.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace grainfield::report {

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

const RunRecord* source_of(const Results& run, const std::string& command) {
    const auto found = std::ranges::find(run.sources, command, &RunRecord::command);
    return found == run.sources.end() ? nullptr : &*found;
}

// Γ = Aω²/g, where gravity is there.
std::optional<double> acceleration(const RunRecord& md) {
    const auto amplitude = number(md, "vibration.amplitude");
    const auto omega = number(md, "vibration.angular-frequency");
    const double gravity = number(md, "cell.gravity").value_or(1);
    if (!amplitude || !omega || !(gravity > 0)) return std::nullopt;
    return *amplitude * *omega * *omega / gravity;
}

RunIdentity field_identity(const RunRecord& field) {
    RunIdentity identity;
    identity.dimension = number(field, "lattice.dimension").value_or(2) == 1 ? 1 : 2;
    identity.is_field = true;
    identity.origin = fmt::format("field, {}D", identity.dimension);
    if (const auto b = number(field, "model.b")) identity.origin += fmt::format(", b = {:g}", *b);
    identity.parameter = "ν";
    identity.value = number(field, "model.nu");
    return identity;
}

const char* origin_name(Origin origin) {
    switch (origin) {
        case Origin::video:
            return "tracked";
        case Origin::rendered:
            return "true positions";
        case Origin::md:
            return "MD";
        case Origin::points:
            break;
    }
    return "points";
}

}  // namespace

RunIdentity identity_of(const Results& run) {
    if (run.find("critical") != nullptr) return {.origin = "critical"};
    if (const RunRecord* field = source_of(run, "simulate field")) return field_identity(*field);
    RunIdentity identity{.origin = origin_name(run.source.origin)};
    identity.value = number(run.record, "gamma");
    const RunRecord* md = source_of(run, "simulate md");
    if (!identity.value && md != nullptr) identity.value = acceleration(*md);
    if (identity.value) identity.parameter = "Γ";
    return identity;
}

std::vector<RunIdentity> identities_of(const std::vector<Results>& runs) {
    std::vector<RunIdentity> identities;
    identities.reserve(runs.size());
    for (const Results& run : runs) identities.push_back(identity_of(run));
    return identities;
}

bool all_on_a_line(const std::vector<RunIdentity>& identities) {
    return !identities.empty() &&
           std::ranges::all_of(identities, [](const RunIdentity& i) { return i.dimension == 1; });
}

std::string legend_of(const RunIdentity& identity) {
    if (!identity.value) return identity.origin;
    return fmt::format("{}, {} = {:.4g}", identity.origin, identity.parameter, *identity.value);
}

std::vector<std::string> origins_of(const std::vector<RunIdentity>& identities) {
    std::vector<std::string> origins;
    for (const RunIdentity& identity : identities) {
        if (identity.origin == "critical") continue;
        if (std::ranges::find(origins, identity.origin) == origins.end()) {
            origins.push_back(identity.origin);
        }
    }
    return origins;
}

}  // namespace grainfield::report
