#pragma once

#include "analysis/density/number_variance.h"
#include "analysis/observable.h"

namespace grainfield::analysis {

/// The observable "variance": number of particles in sliding windows (NumberVariance).
class VarianceObservable final : public AccumulatorOf<VarianceObservable, NumberVariance::Sample> {
 public:
    static constexpr const char* name = "variance";
    static constexpr bool can_be_saved = true;
    static std::optional<OptionTable> describe(AnalysisOptions& options);
    static void plan(const PlanSetup& setup, RunPlan& plan);
    static std::vector<FigureHint> figures();
    static ObservableTitles titles();

    explicit VarianceObservable(const RunSetup& setup)
        : variance_(setup.options.of<NumberVarianceOptions>(), setup.box, setup.frames_of_run(),
                    setup.threads, setup.first) {}
    Sample measure(const Moment& moment) const { return variance_.measure(moment.pattern()); }
    void add(Sample& sample, const Moment& /*moment*/) { variance_.add(std::move(sample)); }
    void merge(const VarianceObservable& later) { variance_.merge(later.variance_); }
    ObservableResult result(const Inputs& /*inputs*/) const override { return variance_.result(); }
    void save(Checkpoint& checkpoint, const std::string& prefix) const override {
        variance_.save(checkpoint, prefix);
    }
    void restore(const Checkpoint& checkpoint, const std::string& prefix) override {
        variance_.restore(checkpoint, prefix);
    }

 private:
    NumberVariance variance_;
};

}  // namespace grainfield::analysis
