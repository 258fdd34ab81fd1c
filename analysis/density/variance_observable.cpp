#include "analysis/density/variance_observable.h"

namespace grainfield::analysis {

std::optional<OptionTable> VarianceObservable::describe(AnalysisOptions& options) {
    return analysis::describe(options.of<NumberVarianceOptions>());
}

void VarianceObservable::plan(const PlanSetup& setup, RunPlan& plan) {
    plan.run("variance", setup.frames < 2 ? "one frame: over positions" : "temporal, per position");
}

std::vector<FigureHint> VarianceObservable::figures() {
    const auto beside = [](const char* label, const char* curve) {
        return SeriesHint{
            .label = label, .shown = false, .from = {"variance", curve, "l", "variance", "err"}};
    };
    const auto guide = [](const char* label, double exponent, const char* on_a_line) {
        return GuideHint{
            .label = label, .exponent = exponent, .on_a_line = {{on_a_line, exponent - 1}}};
    };
    FigureHint variance{
        .name = "variance",
        .title = "Number variance",
        .note = "",
        .x = {"l", "Window side ℓ", "a", Scale::log, false},
        .y = {"variance", "σ²(ℓ)", "", Scale::log, false},
        .series = {{.label = "σ²(ℓ)", .from = {"variance", "variance", "l", "variance", "err"}},
                   beside("pooled over positions and frames", "variance_pooled"),
                   beside("of the spatial mean", "variance_spatial_mean")},
        .place = 30,
        .presence = Presence::always,
        .title_of_curve = true,
        .panel_by_origin = true,
        .half_of_periodic_box = true,
        .note_of_half_box =
            "Drawn up to half of a periodic box: the fixed number of particles pulls σ² to zero at "
            "ℓ = L",
        .guides = {guide("β = 1", 1, "β = 0"), guide("β = 2", 2, "β = 2")},
        .reading =
            "How much the content of a window of side ℓ varies: in time, of one frame from place "
            "to "
            "place. Along β = 2 density "
            "fluctuates as in a gas; a lower slope means that it is evened out."};
    variance.guides.front().note =
        "Guides: σ² ∝ ⟨N⟩^(β/2). β = 2 grows as the window, ℓ² in the plane and ℓ on a line; the "
        "other one as its edge, ℓ in the plane and constant on a line.";
    return {
        variance,
        {.name = "variance_slope",
         .title = "Local exponent of the number variance",
         .note =
             "In the plane 2 where σ² grows as the window, 1 where it grows as its perimeter; on a "
             "line 1 and 0.",
         .x = {"l", "Window side ℓ", "a", Scale::log, false},
         .y = {"beta", "β(ℓ) = d ln σ²/d ln ℓ", "", Scale::linear, true},
         .series = {{.label = "β(ℓ)", .from = {"variance", "variance_slope", "l", "beta", "err"}}},
         .place = 71}};
}

ObservableTitles VarianceObservable::titles() {
    return {name,
            "Number variance",
            {
                {"number_density", "Number density"},
                {"relative_variance_10a", "σ²/⟨N⟩ at ℓ = 10 a"},
                {"relative_variance_10a_pooled", "σ²/⟨N⟩ at ℓ = 10 a, pooled"},
                {"relative_variance_10a_spatial_mean", "σ²/⟨N⟩ at ℓ = 10 a, of the spatial mean"},
                {"variance_per_volume", "Variance in the largest window, per volume"},
            }};
}

}  // namespace grainfield::analysis
