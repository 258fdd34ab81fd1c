#include "pipelines/lab.h"

#include <fmt/format.h>

namespace grainfield::pipelines {

namespace {

constexpr const char* curve_name = "lab";
constexpr const char* sphere_name = "sphere_mm";
constexpr const char* frequency_name = "vibration_frequency";
constexpr const char* amplitude_name = "vibration_amplitude";

std::optional<double> number_in(const Curve& curve, const char* name) {
    const Column* column = curve.find(name);
    if (column == nullptr || column->values.empty()) return std::nullopt;
    return column->values.front();
}

}  // namespace

void describe(LabUnits& lab, OptionTable& table) {
    table.number("sphere-mm", lab.sphere_mm, "mm", {1e-6, 1e6},
                 "true diameter of the spheres, for lengths in mm besides");
    table.also_called("diameter-mm");
    table.affects(Effect::work);
    table.number("gamma", lab.gamma, "-", {0, 1e6}, "acceleration of the vibration, A omega^2/g");
    table.affects(Effect::work);
    table.number("vibration-frequency", lab.frequency, "Hz", {1e-6, 1e6},
                 "frequency of the vibration");
    table.also_called("frequency");
    table.affects(Effect::work);
    table.number("amplitude-mm", lab.amplitude_mm, "mm", {0, 1e6},
                 "amplitude A of the vibration z = A sin ωt; with its frequency it gives gamma");
    table.affects(Effect::work);
}

void make_room_for(LabUnits& lab, const std::function<bool(const std::string& name)>& is_given) {
    const bool has_amplitude = is_given("amplitude-mm");
    const bool has_frequency = is_given("vibration-frequency");
    if (is_given("gamma")) {
        (has_amplitude ? lab.frequency : lab.amplitude_mm).reset();
    } else if ((has_amplitude && (has_frequency || lab.frequency)) ||
               (has_frequency && lab.amplitude_mm)) {
        lab.gamma.reset();
    }
}

void apply(const LabUnits& lab, TrajectoryInfo& info) {
    if (const auto gamma = lab.acceleration()) {
        info.control = {.parameter = ControlParameter::acceleration, .value = *gamma, .unit = {}};
    }
    if (lab.frequency && info.time_unit == TimeUnit::second) {
        info.vibration_frequency = lab.frequency;
    }
}

std::optional<Curve> curve_of(const LabUnits& lab) {
    Curve curve{curve_name, "Units of the lab", {}, {}};
    const auto add = [&](const char* name, const char* unit, const char* title,
                         const std::optional<double>& value) {
        if (value) curve.columns.push_back({name, unit, title, {*value}});
    };
    add(sphere_name, "mm", "True diameter of the spheres", lab.sphere_mm);
    add(frequency_name, "Hz", "Frequency of the vibration", lab.frequency);
    add(amplitude_name, "mm", "Amplitude of the vibration", lab.amplitude_mm);
    if (curve.columns.empty()) return std::nullopt;
    return curve;
}

LabUnits lab_units_in(const std::vector<Curve>& curves) {
    LabUnits lab;
    for (const Curve& curve : curves) {
        if (curve.name != curve_name) continue;
        lab.sphere_mm = number_in(curve, sphere_name);
        lab.frequency = number_in(curve, frequency_name);
        lab.amplitude_mm = number_in(curve, amplitude_name);
    }
    return lab;
}

std::string rate_in_words(const TrajectoryInfo& info, RateSource source) {
    if (!info.frame_rate || source == RateSource::unknown) {
        return "not known, times are in frames: give option 'fps'";
    }
    const char* origin = source == RateSource::given  ? "given"
                         : source == RateSource::live ? "as the source says"
                                                      : "from the file: is that the filming rate?";
    return fmt::format("{:.6g} frames a second, {}", *info.frame_rate, origin);
}

std::string scale_in_words(const TrajectoryInfo& info, const LabUnits& lab) {
    std::string text = fmt::format("{:.5g} px a sphere, ", info.diameter);
    text += info.diameter_origin == DiameterOrigin::apparent
                ? "as wide as the discs look: give track.sphere-diameter"
                : "given";
    if (lab.sphere_mm) {
        text += fmt::format("; spheres of {:.5g} mm: 1 px is {:.4g} mm", *lab.sphere_mm,
                            *lab.sphere_mm / info.diameter);
    }
    return text;
}

std::string vibration_in_words(const TrajectoryInfo& info, const LabUnits& lab) {
    std::string text;
    const auto add = [&](const std::string& more) { text += (text.empty() ? "" : ", ") + more; };
    if (info.control && info.control->parameter == ControlParameter::acceleration) {
        add(fmt::format("Γ = {:.4g}", info.control->value));
    }
    if (lab.frequency) add(fmt::format("{:.6g} Hz", *lab.frequency));
    if (lab.amplitude_mm) add(fmt::format("{:.4g} mm", *lab.amplitude_mm));
    return text;
}

std::string units_in_words(const TrajectoryInfo& info, RateSource source, const LabUnits& lab,
                           const RunPlan& plan) {
    std::string text = "  frame rate " + rate_in_words(info, source) + "\n";
    text += "  scale      " + scale_in_words(info, lab) + "\n";
    const std::string moved = vibration_in_words(info, lab);
    if (!moved.empty()) text += "  vibration  " + moved + "\n";
    return plan.wording() ? plan.wording()(text) : text;
}

}  // namespace grainfield::pipelines
