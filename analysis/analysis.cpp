#include "analysis/analysis.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "analysis/run.h"
#include "core/support/interrupt.h"
#include "core/support/parallel.h"

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

// Hands out the patterns of a source and keeps count.
class PatternReader {
 public:
    explicit PatternReader(SnapshotSource& source)
        : source_(source), diameter_(diameter_of(source.info())) {}

    std::vector<Pattern> read(std::int64_t first, std::int64_t count) {
        std::vector<Pattern> patterns;
        for (std::int64_t i = first; i < std::min(first + count, source_.count()); ++i) {
            const Snapshot snapshot = source_.read(i);
            if (i == 0) box_ = snapshot.box;
            particles_ += static_cast<double>(snapshot.size());
            patterns.push_back(pattern_of(snapshot, diameter_));
        }
        return patterns;
    }
    const Box& box() const { return box_; }
    double particles() const { return particles_; }

 private:
    SnapshotSource& source_;
    double diameter_;
    Box box_{};
    double particles_ = 0;
};

// While a batch is measured, the one before is added and the next one is read. Long batches keep
// all threads busy, as long as they are small.
void take_all(PatternReader& reader, Run& run, std::int64_t frames, std::int64_t batch, int workers,
              Progress* progress) {
    std::vector<Pattern> next = reader.read(0, batch);
    std::vector<Run::Measured> before;
    const auto add_before = [&] {
        for (Run::Measured& m : before) run.add(std::move(m));
        if (progress != nullptr) progress->advance(static_cast<std::int64_t>(before.size()));
    };
    for (std::int64_t first = 0; first < frames; first += batch) {
        throw_if_interrupted("analysis");
        std::vector<Pattern> patterns = std::exchange(next, {});
        const auto count = static_cast<std::int64_t>(patterns.size());
        std::vector<Run::Measured> measured(patterns.size());
        parallel_for(count + 2, workers, [&](std::int64_t task) {
            if (task == 0) return add_before();
            if (task == 1) {
                next = reader.read(first + batch, batch);
                return;
            }
            const auto at = static_cast<std::size_t>(task - 2);
            measured[at] = run.measure(std::move(patterns[at]), first + task - 2);
        });
        before = std::move(measured);
    }
    add_before();
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
    const PlanSetup setup{options, source.info(), frames, first};
    for (const Observable& observable : wanted) observable.plan(setup, plan);
}

Results measure(SnapshotSource& source, const AnalysisOptions& options,
                const MeasureSettings& settings, const std::vector<Observable>& known) {
    RunPlan own_plan;
    RunPlan& plan = settings.plan != nullptr ? *settings.plan : own_plan;
    plan_measurement(source, options, plan, known);
    Results results;
    results.source = source.info();
    results.frames = source.count();
    const int workers = thread_count(settings.threads);
    PatternReader reader(source);
    Box box{{0, 0}, {1, 1}, {Boundary::walls, Boundary::walls}, 0};
    std::size_t particles = 0;
    if (results.frames > 0) {
        const Pattern first = pattern_of(source.read(0), diameter_of(source.info()));
        box = first.box;
        particles = first.size();
    }
    Run run(chosen(options.observables, known), {.options = options,
                                                 .info = source.info(),
                                                 .box = box,
                                                 .frames = results.frames,
                                                 .threads = workers});
    constexpr std::int64_t most_particles = 200000;  // of a thread
    const std::int64_t each =
        most_particles / std::max<std::int64_t>(1, static_cast<std::int64_t>(particles));
    const std::int64_t batch = std::clamp<std::int64_t>(each, 4, 16) * workers;
    take_all(reader, run, results.frames, batch, workers, settings.progress);
    if (run.dropped() > 0) {
        plan.warn(fmt::format("{} positions that are not finite were left out", run.dropped()));
    }
    results.box = reader.box();
    if (results.frames > 0) {
        results.particles_mean = reader.particles() / static_cast<double>(results.frames);
    }
    results.observables = run.results();
    return results;
}

Results measure(const Trajectory& trajectory, const AnalysisOptions& options,
                const MeasureSettings& settings, const std::vector<Observable>& known) {
    TrajectoryView view(trajectory);
    return measure(view, options, settings, known);
}

}  // namespace grainfield::analysis
