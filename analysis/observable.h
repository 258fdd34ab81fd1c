#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <typeindex>
#include <vector>

#include "analysis/accumulator.h"
#include "analysis/analysis_options.h"
#include "analysis/pattern.h"
#include "core/figure_hint.h"
#include "core/option_table.h"
#include "core/quantity_titles.h"
#include "core/results.h"
#include "core/run_plan.h"

namespace grainfield::analysis {

/// What is known when a run of the analysis begins.
struct RunSetup {
    const AnalysisOptions& options;
    TrajectoryInfo info;
    Box box;  ///< of the first snapshot [a]
    std::int64_t frames = 0;
    int threads = 1;
    std::int64_t first = 0;  ///< number of the first frame, where this is a later part of a run
    std::int64_t whole = 0;  ///< frames of the whole run, where this is a part of it; else 0

    std::int64_t frames_of_run() const { return whole > 0 ? whole : frames; }
};

/// What a plan is made from: the setup and the first snapshot that has particles.
struct PlanSetup {
    const AnalysisOptions& options;
    const TrajectoryInfo& info;
    std::int64_t frames = 0;
    const Pattern& first;
    double interval = 0;  ///< from the first snapshot to the second [time unit]; 0: one
    bool is_linked() const { return !first.id.empty(); }
};

/// Everything that the analysis, the command line and the report know about an observable. Made by
/// `observable_of`.
struct Observable {
    std::string name;           ///< of its section of options, its result and its main curve
    bool has_result = true;     ///< false: work that several observables share
    bool can_be_saved = false;  ///< parts of a run can be measured apart, and merged
    std::type_index type;       ///< of the accumulator

    /// What must be measured before it, of each snapshot and of the run.
    std::function<std::vector<Observable>(const AnalysisOptions&)> needs;
    /// Its table of options, if it has any.
    std::function<std::optional<OptionTable>(AnalysisOptions&)> describe;
    std::function<void(const PlanSetup&, RunPlan&)> plan;
    std::function<std::unique_ptr<Accumulator>(const RunSetup&)> start;
    std::function<std::vector<FigureHint>()> figures;
    std::function<ObservableTitles()> titles;
};

/// What an observable's accumulator derives from. The work of a snapshot has two halves, so that
/// snapshots can be measured by many threads and still give the same bits for any number of them:
///
///   Sample measure(const Moment&) const        heavy; any thread, any order; a pure function
///   void add(Sample&, const Moment&)           light; one thread, in the order of the snapshots
///   void merge(const Derived& later)           adds what was gathered from later snapshots
///   ObservableResult result(const Inputs&) const
///
/// Derived is built from a RunSetup. It has static members `name` and, where the defaults here do
/// not fit, `has_result`, `can_be_saved` (with save and restore, if it gathers anything), `needs`,
/// `describe`, `plan`, `figures` and `titles`. Memory must not grow with the number of snapshots
/// beyond what the class comment states.
template <class Derived, class SampleType>
class AccumulatorOf : public Accumulator {
 public:
    using Sample = SampleType;

    static constexpr bool has_result = true;
    static constexpr bool can_be_saved = false;
    static std::vector<Observable> needs(const AnalysisOptions& /*options*/) { return {}; }
    static std::optional<OptionTable> describe(AnalysisOptions& /*options*/) { return {}; }
    static void plan(const PlanSetup& /*setup*/, RunPlan& /*plan*/) {}
    static std::vector<FigureHint> figures() { return {}; }
    static ObservableTitles titles() { return {Derived::name, Derived::name}; }

    std::unique_ptr<AnySample> measure_any(const Moment& moment) const final {
        return std::make_unique<StoredSample<Sample>>(self().measure(moment));
    }
    void add_any(AnySample& sample, const Moment& moment) final {
        static_cast<Derived&>(*this).add(static_cast<StoredSample<Sample>&>(sample).value, moment);
    }
    void merge_any(const Accumulator& later) final {
        static_cast<Derived&>(*this).merge(static_cast<const Derived&>(later));
    }
    ObservableResult result(const Inputs& /*inputs*/) const override { return {}; }

 private:
    const Derived& self() const { return static_cast<const Derived&>(*this); }
};

template <class A>
Observable observable_of() {
    return {.name = A::name,
            .has_result = A::has_result,
            .can_be_saved = A::can_be_saved,
            .type = typeid(A),
            .needs = &A::needs,
            .describe = &A::describe,
            .plan = &A::plan,
            .start = [](const RunSetup& setup) { return std::make_unique<A>(setup); },
            .figures = &A::figures,
            .titles = &A::titles};
}

}  // namespace grainfield::analysis
