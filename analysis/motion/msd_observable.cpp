#include "analysis/motion/msd_observable.h"

#include "analysis/order/shared_phases.h"

namespace grainfield::analysis {

std::vector<Observable> MsdObservable::needs(const AnalysisOptions& /*options*/) {
    return {observable_of<SharedPhases>()};
}

std::optional<OptionTable> MsdObservable::describe(AnalysisOptions& options) {
    return analysis::describe(options.of<DisplacementOptions>());
}

void MsdObservable::plan(const PlanSetup& setup, RunPlan& plan) {
    if (setup.frames < 2 || !setup.is_linked()) {
        plan.skip("msd", setup.frames < 2 ? "one frame" : "particles are not linked",
                  "16 B a particle and frame");
    } else {
        plan.run("msd", "displacements over pairs of frames");
    }
}

std::vector<FigureHint> MsdObservable::figures() {
    const auto of = [](const char* phase) {
        return SeriesHint{.label = phase,
                          .from = {"msd", "msd", "t", "msd", "err"},
                          .by = "phase",
                          .word = phase};
    };
    const auto fit_of = [](const std::string& phase) {
        return SeriesHint{.label = phase + ", 4 D t + c",
                          .mark = Mark::curve,
                          .from = {"msd", "msd_fit", "t", "msd", ""},
                          .by = "phase",
                          .word = phase};
    };
    return {
        {.name = "msd",
         .title = "Mean squared displacement",
         .note = "",
         .x = {"t", "Lag time t", "time unit", Scale::log, false},
         .y = {"msd", "MSD", "a^2", Scale::log, false},
         .series = {of("all"), of("liquid"), of("solid"), fit_of("all"), fit_of("liquid"),
                    fit_of("solid")},
         .place = 15,
         .presence = Presence::always,
         .one_time_unit = true,
         .panel_by_origin = true,
         .guides = {{.label = "slope 1",
                     .exponent = 1,
                     .place = GuideHint::Place::above_the_end,
                     .note = "Diffusion has slope 1."}},
         .reading = "How far spheres get in a time, squared and averaged. Slope 2 is free flight, "
                    "slope 1 diffusion, a plateau a cage; a liquid ends with slope 1."},
        {.name = "van_hove",
         .title = "Self part of the van Hove function",
         .note = "",
         .x = {"x", "Displacement along an axis", "a", Scale::linear, true},
         .y = {"g", "Density", "1/a", Scale::log, false},
         .series = {{.label = "lag of frames: ",
                     .from = {"msd", "van_hove", "x", "g", "err"},
                     .by = "lag"}},
         .place = 79},
    };
}

ObservableTitles MsdObservable::titles() {
    return {name,
            "Displacement",
            {
                {"d_all", "Diffusion coefficient"},
                {"d_liquid", "Diffusion coefficient, liquid"},
                {"d_solid", "Diffusion coefficient, solid"},
                {"offset_all", "Offset c of MSD = 4 D t + c"},
                {"offset_liquid", "Offset c of MSD = 4 D t + c, liquid"},
                {"offset_solid", "Offset c of MSD = 4 D t + c, solid"},
                {"exponent_all", "MSD exponent"},
                {"exponent_liquid", "MSD exponent, liquid"},
                {"exponent_solid", "MSD exponent, solid"},
            }};
}

ObservableResult MsdObservable::result(const Inputs& inputs) const {
    const PhaseHistory& phases = inputs.of<SharedPhases>().history();
    return displacement_.result(phases.follows() ? &phases : nullptr);
}

}  // namespace grainfield::analysis
