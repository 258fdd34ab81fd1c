#include "app/render_command.h"

#include <cctype>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "app/optics_summary.h"
#include "io/frame_files.h"

namespace grainfield::app {

using nlohmann::ordered_json;

namespace {

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
    own.text("output", job_.output, "FILE.avi or FILE.mkv, else a folder for pictures");
    own.text("truth", job_.truth, "trajectory file for the true positions in pixels");
    own.integer("most-frames", job_.most_frames, "-", {0, 1e12},
                "render no more than these, 0: all");
    own.choice("format", job_.format, writable_formats(), "of pictures in a folder");
    own.flag("resume", job_.resume.resume, "go on from OUTPUT.checkpoint if it is there");
    own.affects(Effect::call);  // a run that was gone on with is recorded as one
    own.number("checkpoint-every", checkpoint_every_, "min", {0, 1e6}, "time between checkpoints");
    own.affects(Effect::work);
    std::vector<OptionTable> tables{own};
    for (OptionTable& table : simulate::describe(job_.render)) tables.push_back(std::move(table));
    return tables;
}

std::vector<std::string> RenderCommand::usual() const {
    return {"output", "truth", "format", "most-frames", "optics",
            "camera", "width", "height", "scale",       "frame-rate"};
}

std::string RenderCommand::default_output(const std::vector<std::filesystem::path>& inputs) const {
    return named_after(inputs, "-film.mkv");
}

Summary RenderCommand::run(Session& session) {
    job_.resume.every = std::chrono::duration<double>(60 * checkpoint_every_);
    if (session.common.explain) {
        pipelines::plan_rendering(job_, session);
        return explanation(session.plan);
    }
    require_output(session, job_.output);
    if (!io::is_video_name(job_.output)) {
        require_folder_name(job_.output, "FILE.avi, FILE.mkv or the name of a folder");
    }
    if (!job_.truth.empty()) require_output(session, job_.truth);
    const pipelines::RenderJobResult result = pipelines::render_frames(job_, session);
    Summary summary;
    summary.signal = result.signal;
    summary.facts["frames"] = result.frames;
    summary.facts["lost_frames"] = result.lost;
    summary.facts["kept_frames"] = result.kept;
    summary.facts["particles_mean"] = result.particles_mean;
    summary.facts["scale_px"] = result.scale;
    summary.facts["frame_rate"] =
        result.frame_rate ? ordered_json(*result.frame_rate) : ordered_json();
    summary.facts["ms_per_frame"] = result.ms_per_frame;
    summary.facts["write_ms_per_frame"] = result.write_ms_per_frame;
    summary.text = fmt::format(
        "{}: {} frames ({} lost{}), {:.0f} spheres a frame, {:.4g} px per diameter\n"
        "  {:.1f} ms a frame to render, {:.1f} ms to write\n",
        job_.output, result.frames, result.lost,
        result.kept > 0 ? fmt::format(", {} of an interrupted run", result.kept) : "",
        result.particles_mean, result.scale, result.ms_per_frame, result.write_ms_per_frame);
    add_optics_summary(result.optics, summary);
    return summary;
}

}  // namespace grainfield::app
