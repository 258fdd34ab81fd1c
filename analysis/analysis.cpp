#include "analysis/analysis.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "analysis/gather.h"
#include "core/support/interrupt.h"

namespace grainfield::analysis {
namespace {

// A region that particles fill only partly makes S(k) and the number variance those of the
// region's shape.
void warn_if_unfilled(const Pattern& pattern, RunPlan& plan) {
    if (pattern.size() < 100) return;
    Vec2 low = pattern.position.front();
    Vec2 high = low;
    for (const Vec2& p : pattern.position) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    const Vec2 filled{(high.x - low.x) / pattern.box.length.x,
                      (high.y - low.y) / pattern.box.length.y};
    if (filled.x > 0.93 && filled.y > 0.93) return;
    plan.warn(fmt::format(
        "particles fill {:.0f} % x {:.0f} % of the box: S(k), its wavevectors and the number "
        "variance refer to the whole box",
        100 * filled.x, 100 * filled.y));
}

// Reads a trajectory that belongs to somebody else.
class TrajectoryView final : public SnapshotSource {
 public:
    explicit TrajectoryView(const Trajectory& trajectory) : trajectory_(trajectory) {}
    const TrajectoryInfo& info() const override { return trajectory_.info; }
    std::int64_t count() const override {
        return static_cast<std::int64_t>(trajectory_.snapshots.size());
    }
    Snapshot read(std::int64_t index) override {
        return trajectory_.snapshots.at(static_cast<std::size_t>(index));
    }

 private:
    const Trajectory& trajectory_;
};

}  // namespace

std::vector<OptionTable> describe(AnalysisOptions& options, const std::vector<Observable>& known) {
    OptionTable choice("analysis");
    choice.names("observables", options.observables, names_for(known),
                 "what to measure; all: every observable");
    std::vector<OptionTable> tables{std::move(choice)};
    for (const Observable& observable : known) {
        if (auto table = observable.describe(options)) tables.push_back(*std::move(table));
    }
    return tables;
}

void plan_measurement(SnapshotSource& source, const AnalysisOptions& options, RunPlan& plan,
                      const std::vector<Observable>& known) {
    const std::vector<Observable> wanted = chosen(options.observables, known);
    const std::int64_t frames = source.count();
    if (frames == 0) {
        plan.skip("all observables", "no frames", "");
        return;
    }
    // The first frames may be empty: they say nothing about the particles.
    const double diameter = diameter_of(source.info());
    Pattern first = pattern_of(source.read(0), diameter);
    for (std::int64_t i = 1; i < frames && first.size() == 0; ++i) {
        throw_if_interrupted("planning the analysis");
        first = pattern_of(source.read(i), diameter);
    }
    if (first.size() == 0) plan.warn("no frame has a particle");
    warn_if_unfilled(first, plan);
    const double interval = frames > 1 ? source.read(1).time - source.read(0).time : 0;
    const PlanSetup setup{options, source.info(), frames, first, interval};
    for (const Observable& observable : wanted) observable.plan(setup, plan);
}

Results measure(SnapshotSource& source, const AnalysisOptions& options,
                const MeasureSettings& settings, const std::vector<Observable>& known) {
    RunPlan own_plan;
    RunPlan& plan = settings.plan != nullptr ? *settings.plan : own_plan;
    plan_measurement(source, options, plan, known);
    Gathered gathered =
        gather(source, chosen(options.observables, known), options, settings, {}, plan);
    Results results;
    results.source = source.info();
    results.frames = source.count();
    results.box = gathered.box;
    if (results.frames > 0) {
        results.particles_mean = gathered.particles / static_cast<double>(results.frames);
    }
    results.observables = gathered.run.results();
    return results;
}

Results measure(const Trajectory& trajectory, const AnalysisOptions& options,
                const MeasureSettings& settings, const std::vector<Observable>& known) {
    TrajectoryView view(trajectory);
    return measure(view, options, settings, known);
}

}  // namespace grainfield::analysis
