#include "app/render_command.h"

#include <cctype>
#include <utility>

#include <fmt/format.h>

#include "app/optics_summary.h"

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
    std::vector<OptionTable> tables{own};
    for (OptionTable& table : simulate::describe(job_.render)) tables.push_back(std::move(table));
    return tables;
}

std::vector<std::string> RenderCommand::usual() const {
    return {"output", "truth", "format", "most-frames", "optics",
            "camera", "width", "height", "scale",       "frame-rate"};
}

Summary RenderCommand::run(Session& session) {
    if (session.common.explain) {
        pipelines::plan_rendering(job_, session);
        return explanation(session.plan);
    }
    require_output(session, job_.output);
    if (!job_.truth.empty()) require_output(session, job_.truth);
    const pipelines::RenderJobResult result = pipelines::render_frames(job_, session);
    Summary summary;
    summary.signal = result.signal;
    summary.facts["frames"] = result.frames;
    summary.facts["lost_frames"] = result.lost;
    summary.facts["particles_mean"] = result.particles_mean;
    summary.facts["scale_px"] = result.scale;
    summary.facts["frame_rate"] =
        result.frame_rate ? ordered_json(*result.frame_rate) : ordered_json();
    summary.facts["ms_per_frame"] = result.ms_per_frame;
    summary.facts["write_ms_per_frame"] = result.write_ms_per_frame;
    summary.text = fmt::format(
        "{}: {} frames ({} lost), {:.0f} spheres a frame, {:.4g} px per diameter\n"
        "  {:.1f} ms a frame to render, {:.1f} ms to write\n",
        job_.output, result.frames, result.lost, result.particles_mean, result.scale,
        result.ms_per_frame, result.write_ms_per_frame);
    add_optics_summary(result.optics, summary);
    return summary;
}

}  // namespace grainfield::app
