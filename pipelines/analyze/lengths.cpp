#include "pipelines/analyze/lengths.h"

#include <algorithm>
#include <utility>

#include "io/h5/trajectory_file.h"
#include "pipelines/lab.h"
#include "pipelines/track/stored_bias.h"

namespace grainfield::pipelines {

namespace {

constexpr const char* curve_name = "calibration";

// In words, for a trajectory that nobody has adjusted.
const char* words(DiameterOrigin origin) {
    switch (origin) {
        case DiameterOrigin::given:
            return "given to track";
        case DiameterOrigin::apparent:
            return "not given: the apparent diameter of the discs stands for it";
        case DiameterOrigin::stated:
        case DiameterOrigin::simulated:
            break;
    }
    return "as the file says";
}

// Whether track was told this number of its discs and fitted nothing.
bool is_given_to_track(const RunRecord& record, const std::string& name) {
    const std::string option = name == "apparent_diameter" ? "disc-diameter"
                               : name == "edge_width"      ? "edge-width"
                                                           : "";
    return !option.empty() && std::ranges::any_of(record.configuration, [&](const auto& entry) {
        return entry.first.ends_with("." + option) && entry.second != automatic;
    });
}

}  // namespace

Curve calibration_curve(double diameter, double edge_width, double residual, double noise) {
    return {curve_name,
            "Discs as the tracker sees them",
            {{"apparent_diameter", "px", "Apparent diameter D", {diameter}},
             {"edge_width", "px", "Edge width w", {edge_width}},
             {"residual", "-", "Residual (RMS, of the contrast)", {residual}},
             {"noise", "-", "Noise of the camera (RMS, of the contrast)", {noise}}},
            {}};
}

ObservableResult lengths_of(const TrajectoryInfo& info, const Adjustment& adjustment) {
    ObservableResult result;
    result.name = "lengths";
    const std::string origin =
        adjustment.particle_diameter ? "given to analyze" : words(info.diameter_origin);
    const std::string unit = info.length_unit == LengthUnit::pixel ? "px" : "a";
    result.measurements.push_back(
        {"particle_diameter", unit, info.diameter, std::nullopt, 0, origin});
    return result;
}

ObservableResult lengths_of(const SnapshotSource& file, const TrajectoryInfo& info,
                            const Adjustment& adjustment) {
    ObservableResult result = lengths_of(info, adjustment);
    const auto* tracks = dynamic_cast<const io::TrajectoryFile*>(&file);
    if (tracks == nullptr) return result;
    for (const Curve& curve : tracks->curves()) {
        if (curve.name != curve_name) continue;
        for (const Column& column : curve.columns) {
            if (column.values.empty()) continue;
            const bool is_given = is_given_to_track(tracks->record(), column.name);
            result.measurements.push_back({column.name, column.unit, column.values.front(),
                                           std::nullopt, 0,
                                           is_given                 ? "given to track"
                                           : column.name == "noise" ? "measured by track"
                                                                    : "fitted by track"});
        }
    }
    if (const auto bias = stored_bias(tracks->curves())) {
        result.measurements.push_back(
            {"bias_correction", "a", bias->moved, std::nullopt, 0, in_words(*bias)});
    }
    if (const auto mm = lab_units_in(tracks->curves()).sphere_mm) {
        result.measurements.push_back(
            {"sphere_mm", "mm", *mm, std::nullopt, 0, "given to " + tracks->record().command});
    }
    return result;
}

void add_times(AdjustedSnapshots& snapshots, ObservableResult& lengths) {
    const std::optional<FilmTimes> times = snapshots.times();
    if (!times) return;
    lengths.measurements.push_back({"film_length", "time unit", times->length, std::nullopt, 0,
                                    "from the first to the last time stamp, and one interval"});
    lengths.measurements.push_back({"frame_interval", "time unit", times->interval, std::nullopt, 0,
                                    "median of the time stamps"});
}

ObservableTitles lengths_titles() {
    return {"lengths",
            "Lengths",
            {{"particle_diameter", "Particle diameter a, unit of all lengths"},
             {"sphere_mm", "True diameter a of the spheres"},
             {"apparent_diameter", "Apparent diameter D of the discs"},
             {"edge_width", "Edge width w of the discs"},
             {"residual", "Residual of the image model (RMS, of the contrast)"},
             {"noise", "Noise of the camera (RMS, of the contrast)"},
             {"bias_correction", "Correction of positions for mirror images (RMS)"},
             {"film_length", "Length of the film"},
             {"frame_interval", "Time from frame to frame"}}};
}

}  // namespace grainfield::pipelines
