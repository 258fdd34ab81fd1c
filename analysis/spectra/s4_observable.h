#pragma once

#include "analysis/observable.h"
#include "analysis/spectra/order_structure_factor.h"

namespace grainfield::analysis {

/// The observable "s4": structure factor of the bond-orientational order (OrderStructureFactor).
class S4Observable final : public AccumulatorOf<S4Observable, OrderStructureFactor::Sample> {
 public:
    static constexpr const char* name = "s4";
    static constexpr bool can_be_saved = true;
    static std::vector<Observable> needs(const AnalysisOptions& options);
    static std::optional<OptionTable> describe(AnalysisOptions& options);
    static void plan(const PlanSetup& setup, RunPlan& plan);
    static std::vector<FigureHint> figures();
    static ObservableTitles titles();

    explicit S4Observable(const RunSetup& setup)
        : sums_(setup.options.of<OrderStructureFactorOptions>(), setup.box, setup.frames_of_run(),
                setup.first) {}
    Sample measure(const Moment& moment) const;
    void add(Sample& sample, const Moment& /*moment*/) { sums_.add(std::move(sample)); }
    void merge(const S4Observable& later) { sums_.merge(later.sums_); }
    ObservableResult result(const Inputs& /*inputs*/) const override { return sums_.result(); }
    void save(Checkpoint& checkpoint, const std::string& prefix) const override {
        sums_.save(checkpoint, prefix);
    }
    void restore(const Checkpoint& checkpoint, const std::string& prefix) override {
        sums_.restore(checkpoint, prefix);
    }

 private:
    OrderStructureFactor sums_;
};

}  // namespace grainfield::analysis
