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

ObservableResult FitObservable::result(const Inputs& inputs) const {
    return fit_result(inputs.of<SharedSpectrum>().sums(), options_);
}

}  // namespace grainfield::analysis
