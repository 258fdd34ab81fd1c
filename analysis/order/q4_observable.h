#pragma once

#include "analysis/observable.h"
#include "analysis/order/bond_statistics.h"
#include "analysis/order/order_correlation.h"

namespace grainfield::analysis {

/// The observable "q4": distribution, means and spacing (BondStatistics), correlation in space and
/// time (OrderCorrelation).
class Q4Observable final : public AccumulatorOf<Q4Observable, OrderCorrelation::Sample> {
 public:
    static constexpr const char* name = "q4";
    static std::vector<Observable> needs(const AnalysisOptions& options);
    static std::optional<OptionTable> describe(AnalysisOptions& options);
    static void plan(const PlanSetup& setup, RunPlan& plan);
    static std::vector<FigureHint> figures();
    static ObservableTitles titles();

    explicit Q4Observable(const RunSetup& setup);
    Sample measure(const Moment& moment) const;
    void add(Sample& sample, const Moment& moment);
    void merge(const Q4Observable& later);
    ObservableResult result(const Inputs& inputs) const override;

 private:
    BondStatistics bonds_;
    OrderCorrelation correlation_;
};

}  // namespace grainfield::analysis
