#include "analysis/pairs/pairs_observable.h"

#include <fmt/format.h>

namespace grainfield::analysis {

std::optional<OptionTable> PairsObservable::describe(AnalysisOptions& options) {
    return analysis::describe(options.of<PairDistributionOptions>());
}

void PairsObservable::plan(const PlanSetup& setup, RunPlan& plan) {
    const auto& options = setup.options.of<PairDistributionOptions>();
    const std::int64_t stride = PairDistribution::stride(options, setup.frames);
    plan.run("gr", stride == 1 ? "every frame" : fmt::format("every {}th frame", stride));
    if (setup.first.z.empty()) {
        plan.skip("gr in space", "heights are not known", "half of its time");
    }
}

std::vector<FigureHint> PairsObservable::figures() {
    return {
        {.name = "gr",
         .title = "Pair distribution",
         .note = "In the plane all particles count; in space those whose height is known.",
         .x = {"r", "Distance", "a", Scale::linear, true},
         .y = {"g", "g(r)", "", Scale::linear, true},
         .series =
             {{.label = "in the plane", .mark = Mark::curve, .from = {"gr", "gr", "s", "g", ""}},
              {.label = "in space", .mark = Mark::curve, .from = {"gr", "gr_space", "r", "g", ""}}},
         .place = 79},
        {.name = "contacts",
         .title = "Contacts of a sphere",
         .note = "Other spheres nearer in space than 1.1 a, or what was set.",
         .x = {"n", "Contacts", "", Scale::linear, true},
         .y = {"share", "Share of spheres", "", Scale::linear, true},
         .series = {{.label = "spheres",
                     .mark = Mark::steps,
                     .from = {"gr", "contacts", "n", "share", ""}}},
         .place = 80}};
}

ObservableTitles PairsObservable::titles() {
    return {name,
            "Pairs",
            {
                {"gr_peak", "Largest value of g(r) in the plane"},
                {"gr_peak_distance", "Distance of the largest g(r)"},
                {"contact_number", "Contacts of a sphere, mean"},
                {"share_too_near", "Share of spheres with another nearer than 0.95 a in space"},
                {"known_heights", "Share of spheres whose height is known"},
            }};
}

}  // namespace grainfield::analysis
