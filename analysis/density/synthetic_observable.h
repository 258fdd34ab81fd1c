#pragma once

#include "analysis/density/synthetic_result.h"
#include "analysis/observable.h"

namespace grainfield::analysis {

/// The observable "synthetic": number variance of other boxes from S(k) and its fit
/// (synthetic_result).
class SyntheticObservable final : public AccumulatorOf<SyntheticObservable, bool> {
 public:
    static constexpr const char* name = "synthetic";
    static constexpr bool can_be_saved = true;
    static std::vector<Observable> needs(const AnalysisOptions& options);
    static std::optional<OptionTable> describe(AnalysisOptions& options);
    static void plan(const PlanSetup& setup, RunPlan& plan);
    static std::vector<FigureHint> figures();
    static ObservableTitles titles();

    explicit SyntheticObservable(const RunSetup& setup)
        : options_(setup.options.of<SyntheticOptions>()) {}
    Sample measure(const Moment& /*moment*/) const { return true; }  // S(k) is all it takes
    void add(Sample& /*sample*/, const Moment& /*moment*/) {}
    void merge(const SyntheticObservable& /*later*/) {}
    ObservableResult result(const Inputs& inputs) const override;

 private:
    SyntheticOptions options_;
};

}  // namespace grainfield::analysis
