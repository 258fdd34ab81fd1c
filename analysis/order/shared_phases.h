#pragma once

#include "analysis/observable.h"
#include "analysis/order/phase.h"

namespace grainfield::analysis {

/// The phase of each particle through the run (PhaseHistory), for "phase" and "msd". Gives no
/// result of its own.
class SharedPhases final : public AccumulatorOf<SharedPhases, PhaseHistory::Sample> {
 public:
    static constexpr const char* name = "phases";
    static constexpr bool has_result = false;
    static std::vector<Observable> needs(const AnalysisOptions& options);

    explicit SharedPhases(const RunSetup& setup)
        : history_(setup.options.of<PhaseOptions>(), setup.info, setup.frames) {}
    Sample measure(const Moment& moment) const;
    void add(Sample& sample, const Moment& moment);
    void merge(const SharedPhases& later) { history_.merge(later.history_); }
    void finish(const Inputs& /*inputs*/) override { history_.close_window(); }

    const PhaseHistory& history() const { return history_; }

 private:
    PhaseHistory history_;
};

}  // namespace grainfield::analysis
