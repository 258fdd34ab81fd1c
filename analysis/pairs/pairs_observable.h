#pragma once

#include "analysis/observable.h"
#include "analysis/pairs/pair_distribution.h"

namespace grainfield::analysis {

/// The observable "gr": pair distributions in the plane and in space, contacts (PairDistribution).
class PairsObservable final : public AccumulatorOf<PairsObservable, PairDistribution::Sample> {
 public:
    static constexpr const char* name = "gr";
    static constexpr bool can_be_saved = true;
    static std::optional<OptionTable> describe(AnalysisOptions& options);
    static void plan(const PlanSetup& setup, RunPlan& plan);
    static std::vector<FigureHint> figures();
    static ObservableTitles titles();

    explicit PairsObservable(const RunSetup& setup)
        : pairs_(setup.options.of<PairDistributionOptions>(), setup.box, setup.frames_of_run(),
                 setup.first) {}
    Sample measure(const Moment& moment) const {
        return pairs_.measure(moment.pattern(), moment.ordinal());
    }
    void add(Sample& sample, const Moment& /*moment*/) { pairs_.add(sample); }
    void merge(const PairsObservable& later) { pairs_.merge(later.pairs_); }
    ObservableResult result(const Inputs& /*inputs*/) const override { return pairs_.result(); }
    void save(Checkpoint& checkpoint, const std::string& prefix) const override {
        pairs_.save(checkpoint, prefix);
    }
    void restore(const Checkpoint& checkpoint, const std::string& prefix) override {
        pairs_.restore(checkpoint, prefix);
    }

 private:
    PairDistribution pairs_;
};

}  // namespace grainfield::analysis
