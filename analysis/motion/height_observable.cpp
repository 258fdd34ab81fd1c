#include "analysis/motion/height_observable.h"

namespace grainfield::analysis {

void HeightObservable::plan(const PlanSetup& setup, RunPlan& plan) {
    if (setup.first.z.empty()) {
        plan.skip("height", "heights are not known", "its whole time");
    } else {
        plan.run("height", "mean of every frame");
    }
}

std::vector<FigureHint> HeightObservable::figures() {
    const auto series = [](const char* label, const char* column) {
        return SeriesHint{
            .label = label, .mark = Mark::curve, .from = {"height", "height", "t", column, ""}};
    };
    return {{.name = "height",
             .title = "Height of the layer",
             .note = "5 % of the centres lie below the lowest line, 95 % below the highest.",
             .x = {"t", "Time t", "time unit", Scale::linear, false},
             .y = {"mean", "Height of the centres", "a", Scale::linear, false},
             .series = {series("mean", "mean"), series("5 %", "low"), series("95 %", "high")},
             .place = 81,
             .least_points = 2,
             .without_time = Axis{"frame", "Frame", "", Scale::linear, false}},
            {.name = "height_profile",
             .title = "Profile of heights",
             .note = "",
             .x = {"z", "Height of the centre", "a", Scale::linear, false},
             .y = {"density", "Density of heights", "1/a", Scale::linear, true},
             .series = {{.label = "density",
                         .mark = Mark::steps,
                         .from = {"height", "height_profile", "z", "density", ""}}},
             .place = 82}};
}

ObservableTitles HeightObservable::titles() {
    return {
        name,
        "Heights",
        {
            {"height_mean", "Mean height of the centres"},
            {"height_spread", "Standard deviation of the heights, motion included"},
            {"height_amplitude", "Amplitude of the layer's vertical motion"},
            {"height_phase", "Phase of the layer's vertical motion at t = 0, parts of a period"},
            {"height_frequency", "Frequency of the layer's vertical motion"},
        }};
}

}  // namespace grainfield::analysis
