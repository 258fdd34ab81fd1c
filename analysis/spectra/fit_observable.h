#pragma once

#include "analysis/observable.h"
#include "analysis/spectra/fit_result.h"

namespace grainfield::analysis {

/// The observable "fit": S0 + S1 (ka)^α through the S(k) of the run (fit_result).
class FitObservable final : public AccumulatorOf<FitObservable, bool> {
 public:
    static constexpr const char* name = "fit";
    static constexpr bool can_be_saved = true;
    static std::vector<Observable> needs(const AnalysisOptions& options);
    static std::optional<OptionTable> describe(AnalysisOptions& options);
    static void plan(const PlanSetup& setup, RunPlan& plan);
    static ObservableTitles titles();

    explicit FitObservable(const RunSetup& setup) : options_(setup.options.of<FitOptions>()) {}
    Sample measure(const Moment& /*moment*/) const { return true; }  // S(k) is all it takes
    void add(Sample& /*sample*/, const Moment& /*moment*/) {}
    void merge(const FitObservable& /*later*/) {}
    ObservableResult result(const Inputs& inputs) const override;

 private:
    FitOptions options_;
};

}  // namespace grainfield::analysis
