#include "analysis/density/synthetic_observable.h"

#include "analysis/spectra/fit_observable.h"
#include "analysis/spectra/sk_observable.h"

namespace grainfield::analysis {

std::vector<Observable> SyntheticObservable::needs(const AnalysisOptions& /*options*/) {
    return {observable_of<SharedSpectrum>(), observable_of<FitObservable>()};
}

std::optional<OptionTable> SyntheticObservable::describe(AnalysisOptions& options) {
    return analysis::describe(options.of<SyntheticOptions>());
}

void SyntheticObservable::plan(const PlanSetup& /*setup*/, RunPlan& plan) {
    plan.run("synthetic", "number variance of other boxes from S(k), where it has a fit");
}

std::vector<FigureHint> SyntheticObservable::figures() {
    return {
        {.name = "synthetic",
         .title = "Number variance of other boxes, from S(k)",
         .note =
             "Boxes are periodic with a fixed number of particles: σ² vanishes at ℓ = L. Above "
             "the measured k S = 1 is taken (of a field its last value), which shows at small ℓ.",
         .x = {"l", "Window side ℓ", "a", Scale::log, false},
         .y = {"variance", "σ²(ℓ)", "", Scale::log, false},
         .series = {{.label = "L = ",
                     .from = {"synthetic", "synthetic", "l", "variance", "err"},
                     .by = "side",
                     .negligible_end = 1e-6},
                    {.label = "counted", .from = {"variance", "variance", "l", "variance", "err"}}},
         .place = 70,
         .panel_by_origin = true}};
}

ObservableTitles SyntheticObservable::titles() {
    return {name,
            "Number variance of other boxes",
            {
                {"crossover_length", "Crossover length ℓ*"},
            },
            {{"box_", "Number variance of a box of ", " a"}}};
}

ObservableResult SyntheticObservable::result(const Inputs& inputs) const {
    return synthetic_result(
        synthetic_input(inputs.of<SharedSpectrum>().sums(), inputs.result_of<FitObservable>()),
        options_);
}

}  // namespace grainfield::analysis
