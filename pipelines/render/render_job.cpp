#include "pipelines/render/render_job.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "io/h5/trajectory_file.h"
#include "io/input_record.h"
#include "io/open_snapshots.h"
#include "pipelines/configuration.h"
#include "pipelines/interrupt_deadline.h"
#include "pipelines/render/kept_frames.h"
#include "pipelines/render/snapshot_window.h"
#include "simulate/render/motion/grain_motion.h"
#include "simulate/render/motion/lasting_ids.h"

namespace grainfield::pipelines {

namespace {

using Clock = std::chrono::steady_clock;

constexpr double slow_frame = 1;  // [s]

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

/// All that frames and truth depend on.
Resumable::Identity identity_of(const RenderJobOptions& options, const Job& job) {
    simulate::RenderOptions render = options.render;
    Configuration compared = physics_of(simulate::describe(render));
    compared.emplace_back("most-frames", std::to_string(options.most_frames));
    compared.emplace_back("truth", options.truth);
    compared.emplace_back("seed", std::to_string(job.seed));
    const bool is_video = io::is_video_name(options.output);
    if (!is_video) compared.emplace_back("format", std::string(options.format->name));
    const RunRecord::Input input = io::describe_input(job.inputs.front());
    throw_if_interrupted("rendering");
    compared.emplace_back("input", fmt::format("{} bytes, {}", input.bytes, input.checksum));
    // Beside a folder, not in it.
    std::filesystem::path output = options.output;
    if (!output.has_filename()) output = output.parent_path();
    return {.kind = "render",
            .output = std::move(output),
            .log = is_video ? KeptFrames::log_suffix : "",
            .configuration = std::move(compared),
            .record = options.truth};
}

/// What was rendered so far.
struct Tally {
    std::int64_t frames = 0;
    std::int64_t lost = 0;
    std::int64_t kept = 0;  ///< of the frames: an interrupted run had rendered them
    double render_seconds = 0;
    double write_seconds = 0;
    double spheres = 0;
    simulate::SamplingCheck check;

    std::int64_t done() const { return frames + lost; }
    std::int64_t rendered() const { return frames - kept; }
};

Tally render_all(const RenderJobOptions& options, Scene& scene, const Job& job,
                 const Resumable& resumable, KeptFrames& frames, io::TrajectoryWriter* truth) {
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
        const auto begun = Clock::now();
        const simulate::SnapshotSeries series =
            window.around(scene.chosen[i], renderer.half_exposure());
        if (tally.frames == 0) tally.check = scene.check(series, job);
        // A video cannot leave a place empty: what follows a lost frame moves up, as from a camera.
        const std::int64_t place = video ? tally.frames : index;
        Snapshot positions;
        const bool is_kept = index < frames.done() && frames.restore(place);
        if (is_kept) {
            positions = renderer.truth(series, index);
            ++tally.kept;
        } else {
            const auto start = Clock::now();
            simulate::RenderedFrame rendered = renderer.render(series, index);
            tally.render_seconds += seconds_since(start);
            const auto start_writing = Clock::now();
            rendered.frame.index = place;
            frames.write(rendered.frame);
            tally.write_seconds += seconds_since(start_writing);
            positions = std::move(rendered.truth);
        }
        const auto start_writing = Clock::now();
        positions.frame = place;
        ids.follow(positions);
        ids.renumber(positions, tally.frames);
        if (truth != nullptr) truth->write(positions);
        tally.write_seconds += seconds_since(start_writing);
        tally.spheres += static_cast<double>(positions.size());
        ++tally.frames;
        if (is_kept) {
            progress.resume_at(1);
        } else {
            progress.advance();
        }
        // What was done before stays vouched for. A signal does not wait for a slow frame, so that
        // those before it are saved at once.
        const bool is_slow = seconds_since(begun) > slow_frame;
        if ((is_slow || resumable.is_due()) && index >= frames.done()) frames.save(tally.done());
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
                           .suggestion =
                               "leave out exposure.frame-rate for one frame a snapshot, or "
                               "simulate again with a smaller run.snapshot-every"});
    }
    for (std::int64_t i = 0;; ++i) {
        const auto at = static_cast<std::int64_t>(std::llround(static_cast<double>(i) * step));
        if (at >= count) return chosen;
        chosen.push_back(at);
    }
}

void plan_rendering(const RenderJobOptions& options, Job& job) {
    const Scene scene = open_scene(options, job);
    // A plan need not name an output.
    Resumable(job, identity_of(options, job), options.resume).explain();
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
    std::optional<DiscardDeadline> starting(std::in_place, "rendering", options.output);
    Scene scene = open_scene(options, job);
    Resumable resumable(job, identity_of(options, job), options.resume);
    resumable.require_free();
    resumable.explain();
    starting.reset();
    const InterruptDeadline deadline([&](int signal) { return resumable.cut_off(signal); });
    const simulate::Renderer& renderer = *scene.renderer;
    const bool is_video = io::is_video_name(options.output);
    const io::FrameWriterOptions announced{.format = options.format,
                                           .width = renderer.view().width(),
                                           .height = renderer.view().height(),
                                           .bit_depth = scene.options.sensor.bits,
                                           .fps = scene.options.exposure.frame_rate};
    const auto writer = io::make_frame_writer(options.output, announced, resumable.overwrite());
    std::optional<io::TrajectoryWriter> truth;
    if (!options.truth.empty()) {
        truth.emplace(options.truth, renderer.truth_info(), resumable.overwrite());
    }
    resumable.start();
    KeptFrames kept(resumable, *writer, announced, is_video);
    const Tally tally = render_all(options, scene, job, resumable, kept, truth ? &*truth : nullptr);
    const auto asked = static_cast<std::int64_t>(scene.chosen.size());
    const bool is_done = tally.done() == asked;
    // Before the output, which takes its time to be completed.
    if (tally.done() > kept.done()) kept.save(tally.done());
    if (tally.frames > 0 || !is_video) {
        writer->finish();
        for (const auto& path : writer->outputs()) job.outputs.push_back(path);
    }
    if (truth) {
        truth->finish(job.record());
        job.outputs.emplace_back(options.truth);
    }
    if (is_done) resumable.finish();
    const double frames = static_cast<double>(std::max<std::int64_t>(tally.frames, 1));
    const double rendered = static_cast<double>(std::max<std::int64_t>(tally.rendered(), 1));
    RenderJobResult result{.frames = tally.frames,
                           .lost = tally.lost,
                           .kept = tally.kept,
                           .particles_mean = tally.spheres / frames,
                           .scale = renderer.view().scale(),
                           .frame_rate = scene.options.exposure.frame_rate,
                           .ms_per_frame = 1e3 * tally.render_seconds / rendered,
                           .write_ms_per_frame = 1e3 * tally.write_seconds / frames,
                           .optics = optics_use(renderer, tally.rendered(), tally.check),
                           .signal = caught_signal()};
    if (tally.frames > 0 && tally.spheres <= 0) {
        job.plan.warn("no sphere is in view; see view.centre-x, view.centre-y and view.scale");
    }
    if (result.signal != 0) {
        job.plan.warn(resumable.interrupted(static_cast<double>(tally.done()),
                                            static_cast<double>(asked), "frames",
                                            ", which are kept"));
    }
    return result;
}

}  // namespace grainfield::pipelines
