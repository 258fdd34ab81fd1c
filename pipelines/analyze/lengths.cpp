#include "pipelines/analyze/lengths.h"

#include <algorithm>
#include <utility>

#include "io/h5/trajectory_file.h"

namespace grainfield::pipelines {

namespace {

constexpr const char* curve_name = "calibration";

// Whether the track command was told the true diameter.
bool was_given(const RunRecord& record) {
    return std::ranges::any_of(record.configuration, [](const auto& entry) {
        return entry.first == "track.sphere-diameter" && entry.second != "auto" &&
               !entry.second.empty();
    });
}

}  // namespace

Curve calibration_curve(double diameter, double edge_width, double residual) {
    return {curve_name,
            "Discs as the tracker sees them",
            {{"apparent_diameter", "px", "Apparent diameter D", {diameter}},
             {"edge_width", "px", "Edge width w", {edge_width}},
             {"residual", "-", "Residual (RMS, of the contrast)", {residual}}},
            {}};
}

ObservableResult lengths_of(const SnapshotSource& file, const TrajectoryInfo& info,
                            const Adjustment& adjustment) {
    ObservableResult result;
    result.name = "lengths";
    const auto* tracks = dynamic_cast<const io::TrajectoryFile*>(&file);
    std::string origin = "as the file says";
    if (adjustment.diameter) {
        origin = "given to analyze";
    } else if (info.origin == Origin::video && tracks != nullptr) {
        origin = was_given(tracks->record())
                     ? "given to track"
                     : "not given: the apparent diameter of the discs stands for it";
    }
    const std::string unit = info.length_unit == LengthUnit::pixel ? "px" : "a";
    result.measurements.push_back(
        {"particle_diameter", unit, info.diameter, std::nullopt, 0, origin});
    if (tracks == nullptr) return result;
    for (const Curve& curve : tracks->curves()) {
        if (curve.name != curve_name) continue;
        for (const Column& column : curve.columns) {
            if (column.values.empty()) continue;
            result.measurements.push_back({column.name, column.unit, column.values.front(),
                                           std::nullopt, 0, "fitted by track"});
        }
    }
    return result;
}

}  // namespace grainfield::pipelines
