#include "analysis/gather.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "core/support/interrupt.h"
#include "core/support/parallel.h"

namespace grainfield::analysis {
namespace {

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
// all threads busy, as long as they are small. A snapshot has the number that it has in the whole,
// of which the source may be a part: what thins by it takes the same snapshots of any part.
void take_all(PatternReader& reader, Run& run, std::int64_t frames, std::int64_t begin,
              std::int64_t batch, int workers, Progress* progress) {
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
            measured[at] = run.measure(std::move(patterns[at]), begin + first + task - 2);
        });
        before = std::move(measured);
    }
    add_before();
}

}  // namespace

Gathered gather(SnapshotSource& source, const std::vector<Observable>& wanted,
                const AnalysisOptions& options, const MeasureSettings& settings,
                const PartOfRun& part, RunPlan& plan) {
    const std::int64_t frames = source.count();
    const int workers = thread_count(settings.threads);
    PatternReader reader(source);
    Box box{{0, 0}, {1, 1}, {Boundary::walls, Boundary::walls}, 0};
    std::size_t particles = 0;
    if (frames > 0) {
        const Pattern first = pattern_of(source.read(0), diameter_of(source.info()));
        box = first.box;
        particles = first.size();
    }
    Run run(wanted, {.options = options,
                     .info = source.info(),
                     .box = box,
                     .frames = frames,
                     .threads = workers,
                     .first = part.first,
                     .whole = part.whole});
    constexpr std::int64_t most_particles = 200000;  // of a thread
    const std::int64_t each =
        most_particles / std::max<std::int64_t>(1, static_cast<std::int64_t>(particles));
    const std::int64_t batch = std::clamp<std::int64_t>(each, 4, 16) * workers;
    take_all(reader, run, frames, part.first, batch, workers, settings.progress);
    if (run.dropped() > 0) {
        plan.warn(fmt::format("{} positions that are not finite were left out", run.dropped()));
    }
    return {std::move(run), reader.box(), reader.particles()};
}

}  // namespace grainfield::analysis
