#pragma once

#include "analysis/motion/displacement.h"
#include "analysis/observable.h"

namespace grainfield::analysis {

/// The observable "msd": mean squared displacement (Displacement) of all particles and, where they
/// can be followed, by phase.
class MsdObservable final : public AccumulatorOf<MsdObservable, bool> {
 public:
    static constexpr const char* name = "msd";
    static std::vector<Observable> needs(const AnalysisOptions& options);
    static std::optional<OptionTable> describe(AnalysisOptions& options);
    static void plan(const PlanSetup& setup, RunPlan& plan);
    static std::vector<FigureHint> figures();
    static ObservableTitles titles();

    explicit MsdObservable(const RunSetup& setup)
        : displacement_(setup.options.of<DisplacementOptions>(), setup.frames, setup.threads) {}
    Sample measure(const Moment& /*moment*/) const { return true; }  // positions are all it takes
    void add(Sample& /*sample*/, const Moment& moment) { displacement_.add(moment.pattern()); }
    void merge(const MsdObservable& later) { displacement_.merge(later.displacement_); }
    ObservableResult result(const Inputs& inputs) const override;

 private:
    Displacement displacement_;
};

}  // namespace grainfield::analysis
