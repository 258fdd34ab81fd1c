#include "analysis/spectra/fit_observable.h"

#include "analysis/spectra/sk_observable.h"

namespace grainfield::analysis {

std::vector<Observable> FitObservable::needs(const AnalysisOptions& /*options*/) {
    return {observable_of<SharedSpectrum>()};
}

std::optional<OptionTable> FitObservable::describe(AnalysisOptions& options) {
    return analysis::describe(options.of<FitOptions>());
}

void FitObservable::plan(const PlanSetup& setup, RunPlan& plan) {
    if (setup.frames < 2 && !setup.first.box.is_periodic()) {
        plan.skip("fit", "one frame: S(k) has the walls in it", "");
    } else {
        plan.run("fit", "S0 + S1 (ka)^alpha below the pre-peak, if there is one");
    }
}

ObservableTitles FitObservable::titles() {
    return {name,
            "Fit of S(k)",
            {
                {"s0_over_s1", "S₀/S₁"},
                {"s0", "S₀"},
                {"s1", "S₁"},
                {"alpha", "Exponent α"},
                {"k_pre_peak", "Wavevector of the pre-peak"},
                {"k_fit", "End of the fit"},
                {"chi2_per_dof", "χ² per degree of freedom"},
                {"s_growth", "S of the range, last third of the run over the first"},
                {"s0_s1_correlation", "Correlation of the errors of S₀ and S₁"},
                {"s0_over_s1_low", "S₀/S₁, lower end"},
                {"s0_over_s1_high", "S₀/S₁, upper end"},
                {"s0_over_s1_connected", "S₀/S₁ from plane waves"},
                {"s0_over_s1_neumann", "S₀/S₁ from modes between walls"},
                {"s0_over_s1_systematic_alpha", "S₀/S₁, systematic of α"},
                {"s0_over_s1_systematic_range", "S₀/S₁, systematic of the range"},
                {"s0_over_s1_systematic_grid", "S₀/S₁, systematic of the shells"},
            }};
}

ObservableResult FitObservable::result(const Inputs& inputs) const {
    return fit_result(inputs.of<SharedSpectrum>().sums(), options_);
}

}  // namespace grainfield::analysis
