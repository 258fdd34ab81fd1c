#include "app/render_command.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "app/optics_summary.h"
#include "core/errors.h"
#include "core/support/interrupt.h"
#include "core/support/progress.h"
#include "io/open_snapshots.h"
#include "pipelines/render/snapshot_window.h"
#include "simulate/render/grain_motion.h"
#include "simulate/render/lasting_ids.h"

namespace grainfield::app {

namespace {

using nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

void explain_inputs(const TrajectoryInfo& info, const Snapshot& first, RunPlan& plan) {
    if (first.z.empty() && first.layer.empty()) {
        plan.warn("the trajectory has neither heights nor layers: all spheres on the low plate");
    }
    if (info.time_unit == TimeUnit::frame) {
        plan.warn("the trajectory has no clock: no motion blur; --frame-rate gives one");
    }
}

std::vector<std::pair<std::string, const io::ImageFormat*>> writable_formats() {
    std::vector<std::pair<std::string, const io::ImageFormat*>> formats;
    for (const io::ImageFormat& format : io::image_formats()) {
        if (format.write == nullptr) continue;
        std::string name(format.name);
        for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        formats.emplace_back(name, &format);
    }
    return formats;
}

}  // namespace

std::vector<std::int64_t> snapshots_at_rate(std::int64_t count, double interval, double rate) {
    std::vector<std::int64_t> chosen;
    const double step = interval > 0 && rate > 0 ? 1 / (rate * interval) : 1;
    if (step < 1 - 1e-6) {
        throw OptionError({.problem = "exposure.frame-rate: there are too few snapshots",
                           .actual = fmt::format("{:.6g} frames/s", rate),
                           .expected = fmt::format("at most {:.6g}, one a snapshot", 1 / interval),
                           .suggestion = "simulate again with a smaller --snapshot-every"});
    }
    for (std::int64_t i = 0;; ++i) {
        const auto at = static_cast<std::int64_t>(std::llround(static_cast<double>(i) * step));
        if (at >= count) return chosen;
        chosen.push_back(at);
    }
}

std::string RenderCommand::purpose() const {
    return "camera frames of a trajectory, with the true positions";
}

Command::Inputs RenderCommand::inputs() const {
    return {.placeholder = "TRAJECTORY",
            .meaning = "H5MD file with heights or layers, e.g. of 'simulate md'",
            .count = Count::one};
}

std::vector<OptionTable> RenderCommand::options() {
    OptionTable own("");
    own.text("output", output_, "FILE.avi or FILE.mkv, else a folder for pictures");
    own.text("truth", truth_, "trajectory file for the true positions in pixels");
    own.integer("most-frames", most_frames_, "-", {0, 1e12}, "render no more than these, 0: all");
    own.choice("format", format_, writable_formats(), "of pictures in a folder");
    std::vector<OptionTable> tables{own};
    for (OptionTable& table : simulate::describe(render_)) tables.push_back(std::move(table));
    return tables;
}

std::optional<double> RenderCommand::rate_of(const SnapshotSource& source, const Snapshot& first,
                                             const std::optional<Snapshot>& second,
                                             double seconds_per_unit) const {
    if (render_.exposure.frame_rate) return render_.exposure.frame_rate;
    if (!(seconds_per_unit > 0)) return std::nullopt;
    if (second && second->time > first.time) {
        return 1 / ((second->time - first.time) * seconds_per_unit);
    }
    if (source.info().frame_rate) return *source.info().frame_rate / seconds_per_unit;
    return std::nullopt;
}

RenderCommand::Tally RenderCommand::render_all(Session& session, SnapshotSource& source,
                                               const std::vector<std::int64_t>& chosen,
                                               simulate::Renderer& renderer,
                                               io::FrameWriter& writer,
                                               io::TrajectoryWriter* truth) const {
    const bool video = io::is_video_name(output_);
    Tally tally;
    pipelines::SnapshotWindow window(source);
    simulate::LastingIds ids(renderer.crossing_span(source.read(0).box));
    Progress progress("rendering", static_cast<std::int64_t>(chosen.size()), "frames",
                      session.verbosity);
    if (render_.optics == simulate::OpticsKind::raytrace) progress.announce();
    for (std::size_t i = 0; i < chosen.size() && caught_signal() == 0; ++i) {
        const auto index = static_cast<std::int64_t>(i);
        if (renderer.loses(index)) {
            ++tally.lost;
            progress.advance();
            continue;
        }
        const simulate::SnapshotSeries series = window.around(chosen[i], renderer.half_exposure());
        if (tally.frames == 0) {
            tally.check = simulate::check_sampling(render_, renderer.view(), source.info(), series,
                                                   session.seed, session.threads);
        }
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

Summary RenderCommand::run(Session& session) {
    const auto source = io::open_snapshots(session.inputs.front(), std::nullopt, {});
    if (source->count() == 0) {
        throw InputError(fmt::format("'{}' holds no frames.", session.inputs.front().string()));
    }
    const Snapshot first = source->read(0);
    std::optional<Snapshot> second;
    if (source->count() > 1) second = source->read(1);
    explain_inputs(source->info(), first, session.plan);
    const double unit = simulate::seconds_per_unit(source->info(), render_);
    const std::optional<double> rate = rate_of(*source, first, second, unit);
    const bool clocked = source->info().time_unit != TimeUnit::frame && second && rate;
    std::vector<std::int64_t> chosen = snapshots_at_rate(
        source->count(), clocked ? (second->time - first.time) * unit : 0, rate.value_or(0));
    if (most_frames_ > 0 && static_cast<std::int64_t>(chosen.size()) > most_frames_) {
        chosen.resize(static_cast<std::size_t>(most_frames_));
    }
    simulate::RenderOptions options = render_;
    options.exposure.frame_rate = rate;
    simulate::Renderer renderer(options, source->info(), first.box, session.seed, session.threads,
                                session.plan);
    if (truth_.empty()) {
        session.plan.skip("truth", "no --truth FILE", "a trajectory file");
    } else {
        session.plan.run("truth", fmt::format("positions in pixels to '{}'", truth_));
    }
    if (session.common.explain) {
        pipelines::SnapshotWindow window(*source);
        explain_rays(
            simulate::check_sampling(options, renderer.view(), source->info(),
                                     window.around(chosen.front(), renderer.half_exposure()),
                                     session.seed, session.threads),
            session.plan);
        return explanation(session.plan);
    }
    require_output(session, output_);
    if (!truth_.empty()) require_output(session, truth_);

    const auto overwrite = session.overwrite;
    const auto writer = io::make_frame_writer(output_,
                                              {.format = format_,
                                               .width = renderer.view().width(),
                                               .height = renderer.view().height(),
                                               .bit_depth = options.sensor.bits,
                                               .fps = rate},
                                              overwrite);
    std::optional<io::TrajectoryWriter> truth;
    if (!truth_.empty()) truth.emplace(truth_, renderer.truth_info(), overwrite);
    const Tally tally =
        render_all(session, *source, chosen, renderer, *writer, truth ? &*truth : nullptr);
    if (tally.frames > 0 || !io::is_video_name(output_)) {
        writer->finish();
        for (const auto& path : writer->outputs()) session.outputs.push_back(path);
    }
    if (truth) {
        truth->finish(session.record());
        session.outputs.emplace_back(truth_);
    }

    const double frames = static_cast<double>(std::max<std::int64_t>(tally.frames, 1));
    Summary summary;
    summary.facts["frames"] = tally.frames;
    summary.facts["lost_frames"] = tally.lost;
    summary.facts["particles_mean"] = tally.spheres / frames;
    summary.facts["scale_px"] = renderer.view().scale();
    summary.facts["frame_rate"] = rate ? ordered_json(*rate) : ordered_json();
    summary.facts["ms_per_frame"] = 1e3 * tally.render_seconds / frames;
    summary.facts["write_ms_per_frame"] = 1e3 * tally.write_seconds / frames;
    summary.text = fmt::format(
        "{}: {} frames ({} lost), {:.0f} spheres a frame, {:.4g} px per diameter\n"
        "  {:.1f} ms a frame to render, {:.1f} ms to write\n",
        output_, tally.frames, tally.lost, tally.spheres / frames, renderer.view().scale(),
        1e3 * tally.render_seconds / frames, 1e3 * tally.write_seconds / frames);
    add_optics_summary(renderer, tally.frames, tally.check, summary);
    if (tally.frames > 0 && tally.spheres <= 0) {
        session.plan.warn("no sphere is in view; see --centre-x, --centre-y and --scale");
    }
    if (caught_signal() != 0) {
        session.plan.warn(fmt::format("interrupted after {} of {} frames, which are kept",
                                      tally.frames + tally.lost, chosen.size()));
        summary.signal = caught_signal();
    }
    return summary;
}

}  // namespace grainfield::app
