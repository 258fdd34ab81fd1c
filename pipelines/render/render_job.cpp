#include "pipelines/render/render_job.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "io/h5/trajectory_file.h"
#include "io/open_snapshots.h"
#include "pipelines/render/snapshot_window.h"
#include "simulate/render/motion/grain_motion.h"
#include "simulate/render/motion/lasting_ids.h"

namespace grainfield::pipelines {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The trajectory, the snapshots of it that the camera sees, and the camera.
struct Scene {
    std::unique_ptr<SnapshotSource> source;
    std::vector<std::int64_t> chosen;
    simulate::RenderOptions options;  ///< with the frame rate, where it is known
    std::unique_ptr<simulate::Renderer> renderer;

    simulate::SamplingCheck check(const simulate::SnapshotSeries& series, const Job& job) const {
        return simulate::check_sampling(options, renderer->view(), source->info(), series, job.seed,
                                        job.threads);
    }
};

void explain_inputs(const TrajectoryInfo& info, const Snapshot& first, RunPlan& plan) {
    if (first.z.empty() && first.layer.empty()) {
        plan.warn("the trajectory has neither heights nor layers: all spheres on the low plate");
    }
    if (info.time_unit == TimeUnit::frame) {
        plan.warn("the trajectory has no clock: no motion blur; exposure.frame-rate gives one");
    }
}

std::optional<double> rate_of(const simulate::RenderOptions& render, const SnapshotSource& source,
                              const Snapshot& first, const std::optional<Snapshot>& second,
                              double seconds_per_unit) {
    if (render.exposure.frame_rate) return render.exposure.frame_rate;
    if (!(seconds_per_unit > 0)) return std::nullopt;
    if (second && second->time > first.time) {
        return 1 / ((second->time - first.time) * seconds_per_unit);
    }
    if (source.info().frame_rate) return *source.info().frame_rate / seconds_per_unit;
    return std::nullopt;
}

Scene open_scene(const RenderJobOptions& options, Job& job) {
    Scene scene;
    scene.source = io::open_snapshots(job.inputs.front(), std::nullopt, {});
    SnapshotSource& source = *scene.source;
    if (source.count() == 0) {
        throw InputError(fmt::format("'{}' holds no frames.", job.inputs.front().string()));
    }
    const Snapshot first = source.read(0);
    std::optional<Snapshot> second;
    if (source.count() > 1) second = source.read(1);
    explain_inputs(source.info(), first, job.plan);
    const double unit = simulate::seconds_per_unit(source.info(), options.render);
    const std::optional<double> rate = rate_of(options.render, source, first, second, unit);
    const bool clocked = source.info().time_unit != TimeUnit::frame && second && rate;
    scene.chosen = snapshots_at_rate(
        source.count(), clocked ? (second->time - first.time) * unit : 0, rate.value_or(0));
    if (options.most_frames > 0 &&
        static_cast<std::int64_t>(scene.chosen.size()) > options.most_frames) {
        scene.chosen.resize(static_cast<std::size_t>(options.most_frames));
    }
    scene.options = options.render;
    scene.options.exposure.frame_rate = rate;
    scene.renderer = std::make_unique<simulate::Renderer>(scene.options, source.info(), first.box,
                                                          job.seed, job.threads, job.plan);
    if (options.truth.empty()) {
        job.plan.skip("truth", "no file is named for it", "a trajectory file");
    } else {
        job.plan.run("truth", fmt::format("positions in pixels to '{}'", options.truth));
    }
    return scene;
}

/// What was rendered so far.
struct Tally {
    std::int64_t frames = 0;
    std::int64_t lost = 0;
    double render_seconds = 0;
    double write_seconds = 0;
    double spheres = 0;
    simulate::SamplingCheck check;
};

Tally render_all(const RenderJobOptions& options, Scene& scene, const Job& job,
                 io::FrameWriter& writer, io::TrajectoryWriter* truth) {
    simulate::Renderer& renderer = *scene.renderer;
    const bool video = io::is_video_name(options.output);
    Tally tally;
    SnapshotWindow window(*scene.source);
    simulate::LastingIds ids(renderer.crossing_span(scene.source->read(0).box));
    Progress progress("rendering", static_cast<std::int64_t>(scene.chosen.size()), "frames",
                      job.verbosity);
    if (scene.options.optics.chosen().samples()) progress.announce();
    for (std::size_t i = 0; i < scene.chosen.size() && caught_signal() == 0; ++i) {
        const auto index = static_cast<std::int64_t>(i);
        if (renderer.loses(index)) {
            ++tally.lost;
            progress.advance();
            continue;
        }
        const simulate::SnapshotSeries series =
            window.around(scene.chosen[i], renderer.half_exposure());
        if (tally.frames == 0) tally.check = scene.check(series, job);
        const auto start = Clock::now();
        simulate::RenderedFrame rendered = renderer.render(series, index);
        tally.render_seconds += seconds_since(start);
        const auto start_writing = Clock::now();
        // A video cannot leave a place empty: what follows a lost frame moves up, as from a camera.
        const std::int64_t place = video ? tally.frames : index;
        rendered.frame.index = place;
        rendered.truth.frame = place;
        writer.write(rendered.frame);
        ids.follow(rendered.truth);
        ids.renumber(rendered.truth, tally.frames);
        if (truth != nullptr) truth->write(rendered.truth);
        tally.write_seconds += seconds_since(start_writing);
        tally.spheres += static_cast<double>(rendered.truth.size());
        ++tally.frames;
        progress.advance();
    }
    return tally;
}

}  // namespace

std::vector<std::int64_t> snapshots_at_rate(std::int64_t count, double interval, double rate) {
    std::vector<std::int64_t> chosen;
    const double step = interval > 0 && rate > 0 ? 1 / (rate * interval) : 1;
    if (step < 1 - 1e-6) {
        throw OptionError({.problem = "exposure.frame-rate: there are too few snapshots",
                           .actual = fmt::format("{:.6g} frames/s", rate),
                           .expected = fmt::format("at most {:.6g}, one a snapshot", 1 / interval),
                           .suggestion = "simulate again with a smaller run.snapshot-every"});
    }
    for (std::int64_t i = 0;; ++i) {
        const auto at = static_cast<std::int64_t>(std::llround(static_cast<double>(i) * step));
        if (at >= count) return chosen;
        chosen.push_back(at);
    }
}

void plan_rendering(const RenderJobOptions& options, Job& job) {
    const Scene scene = open_scene(options, job);
    SnapshotWindow window(*scene.source);
    plan_rays(
        scene.check(window.around(scene.chosen.front(), scene.renderer->half_exposure()), job),
        job.plan);
}

RenderJobResult render_frames(const RenderJobOptions& options, Job& job) {
    if (!options.truth.empty() && options.truth == options.output) {
        throw OptionError({.problem = "option 'truth' names the output of the frames",
                           .actual = fmt::format("'{}'", options.truth),
                           .expected = "two names",
                           .suggestion = "give the positions a name of their own"});
    }
    Scene scene = open_scene(options, job);
    const simulate::Renderer& renderer = *scene.renderer;
    const auto writer = io::make_frame_writer(options.output,
                                              {.format = options.format,
                                               .width = renderer.view().width(),
                                               .height = renderer.view().height(),
                                               .bit_depth = scene.options.sensor.bits,
                                               .fps = scene.options.exposure.frame_rate},
                                              job.overwrite);
    std::optional<io::TrajectoryWriter> truth;
    if (!options.truth.empty()) truth.emplace(options.truth, renderer.truth_info(), job.overwrite);
    const Tally tally = render_all(options, scene, job, *writer, truth ? &*truth : nullptr);
    if (tally.frames > 0 || !io::is_video_name(options.output)) {
        writer->finish();
        for (const auto& path : writer->outputs()) job.outputs.push_back(path);
    }
    if (truth) {
        truth->finish(job.record());
        job.outputs.emplace_back(options.truth);
    }
    const double frames = static_cast<double>(std::max<std::int64_t>(tally.frames, 1));
    RenderJobResult result{.frames = tally.frames,
                           .lost = tally.lost,
                           .particles_mean = tally.spheres / frames,
                           .scale = renderer.view().scale(),
                           .frame_rate = scene.options.exposure.frame_rate,
                           .ms_per_frame = 1e3 * tally.render_seconds / frames,
                           .write_ms_per_frame = 1e3 * tally.write_seconds / frames,
                           .optics = optics_use(renderer, tally.frames, tally.check),
                           .signal = caught_signal()};
    if (tally.frames > 0 && tally.spheres <= 0) {
        job.plan.warn("no sphere is in view; see view.centre-x, view.centre-y and view.scale");
    }
    if (result.signal != 0) {
        job.plan.warn(fmt::format("interrupted after {} of {} frames, which are kept",
                                  tally.frames + tally.lost, scene.chosen.size()));
    }
    return result;
}

}  // namespace grainfield::pipelines
