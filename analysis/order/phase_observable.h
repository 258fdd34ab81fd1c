#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "analysis/observable.h"
#include "analysis/order/bond_order.h"
#include "analysis/order/order_examples.h"
#include "analysis/order/phase.h"
#include "analysis/order/solid_clusters.h"

namespace grainfield::analysis {

/// The observable "phase": shares of solid and liquid particles (PhaseHistory), clusters of the
/// solid ones (SolidClusters), and |Q4| of one typical particle of each phase (OrderExamples).
class PhaseObservable final : public AccumulatorOf<PhaseObservable, bool> {
 public:
    static constexpr const char* name = "phase";
    static std::vector<Observable> needs(const AnalysisOptions& options);
    static std::optional<OptionTable> describe(AnalysisOptions& options);
    static void plan(const PlanSetup& setup, RunPlan& plan);
    static std::vector<FigureHint> figures();
    static ObservableTitles titles();

    explicit PhaseObservable(const RunSetup& setup);
    Sample measure(const Moment& /*moment*/) const { return true; }  // all of it is shared work
    void add(Sample& sample, const Moment& moment);
    void merge(const PhaseObservable& later);
    void finish(const Inputs& inputs) override;
    ObservableResult result(const Inputs& inputs) const override;

 private:
    struct LastFrame {  // of the open window
        std::vector<std::int64_t> id;
        std::shared_ptr<const BondOrderField> field;
        double time = 0;
    };
    void add_alone(const Moment& moment, const std::shared_ptr<const BondOrderField>& field);
    void add_clusters(const PhaseHistory& history);

    PhaseOptions options_;
    SolidClusters clusters_;
    std::optional<OrderExamples> examples_;  // where particles are followed
    LastFrame last_;
    std::int64_t windows_ = 0;
    std::int64_t frames_ = 0;
    std::int64_t stride_;  // of the frames that stand alone
};

}  // namespace grainfield::analysis
