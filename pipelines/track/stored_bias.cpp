#include "pipelines/track/stored_bias.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace grainfield::pipelines {

namespace {

using tracking::BiasDecision;
using tracking::BiasSource;

constexpr const char* kName = "bias";
constexpr const char* kSource = "source";
constexpr const char* kReason = "reason";
constexpr double kMostCameras = 1e9;

std::optional<std::string> word(const Curve& curve, const char* name) {
    const auto found = curve.text_columns.find(name);
    if (found == curve.text_columns.end() || found->second.size() != 1) return std::nullopt;
    return found->second.front();
}

}  // namespace

Curve curve_of(const BiasDecision& decision) {
    const double unknown = std::numeric_limits<double>::quiet_NaN();
    const bool is_corrected = decision.source != BiasSource::none;
    return {kName,
            "Correction of positions for mirror images of neighbours",
            {{"moved", "a", "Displacement (RMS)", {decision.moved.value_or(unknown)}},
             {"before",
              "a",
              "Error elsewhere without it (RMS, per axis)",
              {is_corrected ? decision.before : unknown}},
             {"after",
              "a",
              "Error elsewhere with it (RMS, per axis)",
              {is_corrected ? decision.after : unknown}},
             {"cameras",
              "-",
              "Cameras that it was learned from",
              {static_cast<double>(decision.cameras)}}},
            {{kSource, {name_of(decision.source)}}, {kReason, {decision.reason}}}};
}

std::optional<BiasDecision> stored_bias(const std::vector<Curve>& curves) {
    const auto found = std::ranges::find(curves, kName, &Curve::name);
    if (found == curves.end()) return std::nullopt;
    const auto number = [&](const char* name) {
        const Column* column = found->find(name);
        return column != nullptr && column->values.size() == 1
                   ? column->values.front()
                   : std::numeric_limits<double>::quiet_NaN();
    };
    const std::optional<std::string> source = word(*found, kSource);
    const std::optional<std::string> reason = word(*found, kReason);
    if (!source || !reason) return std::nullopt;
    const std::optional<BiasSource> named = tracking::bias_source_named(*source);
    const double cameras = number("cameras");
    if (!named || !(cameras >= 0 && cameras <= kMostCameras)) return std::nullopt;
    BiasDecision decision{
        .source = *named, .cameras = std::llround(cameras), .moved = {}, .reason = *reason};
    if (const double moved = number("moved"); std::isfinite(moved)) decision.moved = moved;
    if (*named == BiasSource::none) return decision;
    decision.before = number("before");
    decision.after = number("after");
    if (!std::isfinite(decision.before + decision.after)) return std::nullopt;
    return decision;
}

}  // namespace grainfield::pipelines
