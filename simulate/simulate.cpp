#include "simulate/simulate.h"

#include <cstddef>
#include <memory>
#include <span>
#include <utility>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "core/support/parallel.h"
#include "core/support/team.h"
#include "simulate/field/field_plan.h"
#include "simulate/field/field_run.h"
#include "simulate/field/integrators/integrator_choice.h"
#include "simulate/md/md_simulation.h"
#include "simulate/md/state/initial_state.h"
#include "simulate/render/motion/lasting_ids.h"
#include "simulate/render/renderer.h"

namespace grainfield::simulate {

namespace {

class KeptSnapshots final : public SnapshotSink {
 public:
    explicit KeptSnapshots(std::vector<Snapshot>& snapshots) : snapshots_(snapshots) {}
    void write(const Snapshot& snapshot) override { snapshots_.push_back(snapshot); }

 private:
    std::vector<Snapshot>& snapshots_;
};

class KeptFields final : public FieldSink {
 public:
    explicit KeptFields(std::vector<FieldFrame>& frames) : frames_(frames) {}
    void write(const FieldFrame& frame) override { frames_.push_back(frame); }

 private:
    std::vector<FieldFrame>& frames_;
};

class NoFields final : public FieldSink {
 public:
    void write(const FieldFrame& /*frame*/) override {}
};

// Snapshot `now`, those nearer in time than `reach`, and one more on either side.
SnapshotSeries around(const std::vector<Snapshot>& all, std::size_t now, double reach) {
    std::size_t low = now;
    std::size_t high = now;
    if (reach > 0) {
        while (low > 0 && all[now].time - all[low].time < reach) --low;
        while (high + 1 < all.size() && all[high].time - all[now].time < reach) ++high;
    }
    return {std::span(all).subspan(low, high - low + 1), now - low};
}

// `work` with the threads of the settings held together, and a plan of its own if none is given.
template <class Work>
void with_threads(const RunSettings& settings, const Work& work) {
    RunPlan unread;
    RunPlan& plan = settings.plan != nullptr ? *settings.plan : unread;
    const int threads = thread_count(settings.threads);
    on_team(threads, [&](Team&) { work(threads, plan); });
}

}  // namespace

Trajectory simulate_md(const MdOptions& options, SnapshotSink& sink, const RunSettings& settings) {
    Trajectory trajectory;
    with_threads(settings, [&](int threads, RunPlan& plan) {
        MdSimulation simulation(options, make_initial_state(options, settings.seed), threads, plan);
        trajectory.info = simulation.info();
        while (!simulation.is_done()) {
            simulation.run_window(sink);
            throw_if_interrupted("molecular dynamics");
        }
    });
    return trajectory;
}

Trajectory simulate_md(const MdOptions& options, const RunSettings& settings) {
    std::vector<Snapshot> snapshots;
    KeptSnapshots sink(snapshots);
    Trajectory trajectory = simulate_md(options, sink, settings);
    trajectory.snapshots = std::move(snapshots);
    return trajectory;
}

void simulate_field(const FieldOptions& options, FieldSink& sink, const RunSettings& settings) {
    with_threads(settings, [&](int threads, RunPlan& plan) {
        FieldOptions own = options;
        own.seed = settings.seed;
        own.threads = threads;
        const FieldPlan planned = plan_field(own, plan);
        if (!planned.waves.empty()) {
            throw OptionError({.problem = "scheme: the adjoint one has no density to hand out",
                               .actual = "adjoint",
                               .expected = "auto, lod, explicit or paper",
                               .suggestion = "use AdjointEstimator for its estimates of S(k)"});
        }
        const auto fields = make_integrator(planned.setup, planned.threads);
        NoFields stored;
        FieldRun run(*fields, planned.schedule, sink, stored);
        constexpr std::int64_t between_signals = 100;
        while (!run.is_done()) {
            run.advance(between_signals);
            throw_if_interrupted("the field model");
        }
    });
}

std::vector<FieldFrame> simulate_field(const FieldOptions& options, const RunSettings& settings) {
    std::vector<FieldFrame> frames;
    KeptFields sink(frames);
    simulate_field(options, sink, settings);
    return frames;
}

RenderedFilm render(const Trajectory& trajectory, const RenderOptions& options,
                    const RunSettings& settings) {
    const std::vector<Snapshot>& snapshots = trajectory.snapshots;
    if (snapshots.empty()) throw OptionError("a trajectory without snapshots cannot be rendered.");
    RenderedFilm film;
    with_threads(settings, [&](int threads, RunPlan& plan) {
        const Box& box = snapshots.front().box;
        Renderer renderer(options, trajectory.info, box, settings.seed, threads, plan);
        LastingIds ids(renderer.crossing_span(box));
        film.truth.info = renderer.truth_info();
        for (std::size_t i = 0; i < snapshots.size(); ++i) {
            throw_if_interrupted("rendering");
            RenderedFrame rendered = renderer.render(around(snapshots, i, renderer.half_exposure()),
                                                     static_cast<std::int64_t>(i));
            film.frames.push_back(std::move(rendered.frame));
            if (film.frames.back().status == FrameStatus::missing) continue;
            ids.follow(rendered.truth);
            ids.renumber(rendered.truth, ids.followed() - 1);
            film.truth.snapshots.push_back(std::move(rendered.truth));
        }
    });
    return film;
}

}  // namespace grainfield::simulate
