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
    const auto guide = [](const char* label, double exponent) {
        return GuideHint{.label = label, .exponent = exponent, .halved_on_a_line = true};
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
        .guides = {guide("β = 1", 1), guide("β = 2", 2)},
        .reading =
            "How much the number of spheres in a square window varies in time. Along β = 2 "
            "density fluctuates as in a liquid; a lower slope means that it is evened out."};
    variance.guides.front().note = "Guides: σ² ∝ ⟨N⟩^(β/2), in the plane ℓ^β, on a line ℓ^(β/2).";
    return {
        variance,
        {.name = "variance_slope",
         .title = "Local exponent of the number variance",
         .note = "β = 2: σ² ∝ ⟨N⟩; β = 1: σ² ∝ the perimeter.",
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
                {"variance_per_volume", "Variance in the largest window, per volume"},
            }};
}

}  // namespace grainfield::analysis
