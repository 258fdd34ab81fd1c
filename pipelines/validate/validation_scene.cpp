#include "pipelines/validate/validation_scene.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/stored_trajectory.h"
#include "core/support/interrupt.h"
#include "io/file_kind.h"
#include "io/frame_files.h"
#include "io/joined_films.h"
#include "io/open_snapshots.h"
#include "pipelines/size_check.h"
#include "pipelines/validate/random/random_options.h"
#include "pipelines/validate/validation.h"
#include "simulate/md/md_simulation.h"
#include "simulate/md/state/initial_state.h"
#include "simulate/render/optics/silhouette.h"

namespace grainfield::pipelines {

namespace {

enum class Extent { plan, whole };

/// A run in memory, without what no renderer looks at.
class MovingGrains : public StoredTrajectory {
 public:
    void write(const Snapshot& snapshot) override {
        Snapshot lean = snapshot;
        lean.spin.clear();
        lean.spin.shrink_to_fit();
        StoredTrajectory::write(lean);
    }
};

Snapshot snapshot_of(const simulate::GrainState& state, const simulate::MdOptions& md) {
    Snapshot s;
    const auto side = [](simulate::Side sides) {
        return sides == simulate::Side::walls ? Boundary::walls : Boundary::periodic;
    };
    s.box = {.origin = {},
             .length = {md.cell.length_x, md.cell.length_y},
             .boundary = {side(md.cell.sides_x), side(md.cell.sides_y)},
             .height = md.cell.height};
    for (std::size_t i = 0; i < state.size(); ++i) {
        s.position.push_back({state.position[i].x, state.position[i].y});
        s.z.push_back(state.position[i].z);
        s.velocity.push_back(state.velocity[i]);
        s.id.push_back(state.id[i]);
    }
    return s;
}

/// Particles without identities are numbered as they stand.
class NumberedTruth : public SnapshotSource {
 public:
    explicit NumberedTruth(std::unique_ptr<SnapshotSource> truth) : truth_(std::move(truth)) {}
    const TrajectoryInfo& info() const override { return truth_->info(); }
    std::int64_t count() const override { return truth_->count(); }
    Snapshot read(std::int64_t index) override {
        Snapshot snapshot = truth_->read(index);
        if (snapshot.id.empty()) {
            snapshot.id.resize(snapshot.size());
            std::iota(snapshot.id.begin(), snapshot.id.end(), std::int64_t{0});
        }
        return snapshot;
    }

 private:
    std::unique_ptr<SnapshotSource> truth_;
};

OptionError needs(const char* problem, const char* suggestion) {
    return OptionError(
        {.problem = problem, .actual = {}, .expected = {}, .suggestion = suggestion});
}

ValidationScene given_scene(const SceneOptions& options, Job& job) {
    if (options.truth.empty()) {
        for (const auto& input : job.inputs) {
            if (std::filesystem::is_directory(input) || !std::filesystem::exists(input)) continue;
            const io::FileKind kind = io::identify(input);
            if (kind != io::FileKind::points && kind != io::FileKind::trajectory) continue;
            throw OptionError({.problem = "frames were given without their truth",
                               .actual = fmt::format("'{}' among the frames", input.string()),
                               .expected = {},
                               .suggestion = "give it as option 'truth'"});
        }
        throw needs("frames were given without their truth",
                    "name the file of the true positions: option 'truth'");
    }
    ValidationScene scene;
    job.inputs = io::recording_files(job.inputs);
    scene.frames = io::open_frames(job.inputs, {});
    for (const std::string& warning : scene.frames->warnings()) job.plan.warn(warning);
    const Box frame{.origin = {-0.5, -0.5},
                    .length = {static_cast<double>(scene.frames->width()),
                               static_cast<double>(scene.frames->height())}};
    TrajectoryInfo hints;
    hints.length_unit = LengthUnit::pixel;
    const bool is_one = scene.frames->count() == 1;
    scene.truth =
        io::open_snapshots(options.truth, frame, hints,
                           is_one ? io::FrameColumn::optional : io::FrameColumn::required);
    // Positions of one frame need no identities: nothing follows them.
    if (is_one) scene.truth = std::make_unique<NumberedTruth>(std::move(scene.truth));
    // Images do not say how fast they were taken; the truth may.
    const TrajectoryInfo& known = scene.truth->info();
    if (!scene.frames->frame_rate() && known.frame_rate && known.time_unit == TimeUnit::second) {
        scene.frames = io::open_frames(job.inputs, {.fps = known.frame_rate});
    }
    job.inputs.emplace_back(options.truth);
    if (scene.truth->count() != scene.frames->count()) {
        throw InputError(
            {.problem = fmt::format("'{}' does not belong to these frames", options.truth),
             .actual = fmt::format("{} snapshots", scene.truth->count()),
             .expected = fmt::format("{}, one a frame", scene.frames->count()),
             .suggestion = "give all frames that the truth was written with"});
    }
    return scene;
}

std::unique_ptr<SnapshotSource> make_trajectory(const SceneOptions& options, Job& job,
                                                Extent extent) {
    if (!options.trajectory.empty()) {
        job.inputs.emplace_back(options.trajectory);
        return io::open_snapshots(options.trajectory, std::nullopt, {});
    }
    const double frames = std::max(0.0, options.md.run.periods - options.md.run.discard) /
                          options.md.run.snapshot_every;
    require_memory(frames * static_cast<double>(options.md.cell.grains), available_memory());
    // To explain what ray tracing takes, the state that a run would begin with will do.
    const bool is_shown = extent == Extent::whole || options.render.optics.chosen().samples();
    simulate::GrainState initial;
    if (is_shown) {
        initial = simulate::make_initial_state(options.md, job.seed);
    }
    auto snapshots = std::make_unique<MovingGrains>();
    if (extent == Extent::plan && is_shown) snapshots->write(snapshot_of(initial, options.md));
    simulate::MdSimulation simulation(options.md, std::move(initial), job.threads, job.plan);
    snapshots->set_info(simulation.info());
    if (extent == Extent::plan) return snapshots;
    Progress progress("simulating", static_cast<std::int64_t>(options.md.run.periods), "periods",
                      job.verbosity);
    while (!simulation.is_done()) {
        throw_if_interrupted("validation");
        const double before = simulation.periods_done();
        simulation.run_window(*snapshots);
        progress.advance(static_cast<std::int64_t>(simulation.periods_done() - before));
    }
    return snapshots;
}

ValidationScene rendered_scene(const SceneOptions& options, Job& job, Extent extent) {
    if (!options.truth.empty()) {
        throw needs("the truth was given without frames", "name the frames, or leave it out");
    }
    ValidationScene scene;
    scene.trajectory = make_trajectory(options, job, extent);
    if (scene.trajectory->count() == 0 && extent == Extent::whole) {
        throw InputError({.problem = "nothing to render: the trajectory holds no snapshot",
                          .actual = {},
                          .expected = {},
                          .suggestion = "let run.periods exceed run.discard"});
    }
    const Box box = scene.trajectory->count() > 0
                        ? scene.trajectory->read(0).box
                        : Box{.origin = {},
                              .length = {options.md.cell.length_x, options.md.cell.length_y},
                              .boundary = {Boundary::walls, Boundary::walls},
                              .height = options.md.cell.height};
    auto frames = std::make_unique<RenderedFrames>(*scene.trajectory, box, options.render, job.seed,
                                                   job.threads, job.plan);
    scene.truth = std::make_unique<RenderedTruth>(*frames);
    scene.sphere_diameter = frames->renderer().view().scale();
    scene.vibration_frequency = frames->truth_info().vibration_frequency;
    scene.rendered = frames.get();
    scene.frames = std::move(frames);
    return scene;
}

ValidationScene scene_of(const SceneOptions& options, Job& job, Extent extent) {
    return job.inputs.empty() ? rendered_scene(options, job, extent) : given_scene(options, job);
}

}  // namespace

SceneOptions::SceneOptions() {
    render.optics.add(std::make_unique<RandomOptics>());
    md.cell.grains = 10400;
    md.cell.length_x = md.cell.length_y = 104;
    md.cell.sides_x = md.cell.sides_y = simulate::Side::walls;
    md.initial.layout = simulate::InitialLayout::square;
    md.initial.temperature = 0.1;
    md.run.periods = 14;
    md.run.discard = 10;
    md.run.snapshot_every = 0.1;
    render.view.scale = 16;
    render.optics.of<simulate::Silhouette>().rim = 0.4;
}

ValidationScene open_scene(const SceneOptions& options, Job& job) {
    return scene_of(options, job, Extent::whole);
}

ValidationScene plan_scene(const SceneOptions& options, Job& job) {
    return scene_of(options, job, Extent::plan);
}

}  // namespace grainfield::pipelines
