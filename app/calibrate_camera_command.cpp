#include "app/calibrate_camera_command.h"

#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "app/standard_output.h"
#include "core/errors.h"
#include "pipelines/interrupt_deadline.h"

namespace grainfield::app {

namespace {

using nlohmann::ordered_json;
using pipelines::BoardKind;
using pipelines::CameraJobResult;
using tracking::Camera;
using tracking::PlaneUnit;

const char* name_of(PlaneUnit unit) {
    return unit == PlaneUnit::mm ? "mm" : "a";
}

std::string words(const std::string& output, const CameraJobResult& result) {
    const Camera& camera = result.fit.camera;
    const tracking::Lens& lens = camera.lens;
    std::string text =
        fmt::format("{}: frames of {} x {} px\n", output, camera.width, camera.height);
    if (result.views > 0) {
        text +=
            fmt::format("  board      {} in {} of {}, {}\n",
                        result.board == BoardKind::chessboard ? "a chessboard" : "dots",
                        result.views, counted(result.pictures, "picture"),
                        counted(static_cast<std::int64_t>(result.fit.residuals.size()), "point"));
        text += fmt::format(
            "  lens       focal length {:.5g} px, centre ({:.1f}, {:.1f}) px{}; k1 {:.4g}, k2 "
            "{:.4g}, p1 {:.2g}, p2 {:.2g}\n",
            lens.focal, lens.centre.x, lens.centre.y,
            result.fit.is_centre_fitted ? "" : " (of the frame)", lens.k1, lens.k2, lens.p1,
            lens.p2);
    }
    if (result.walls) {
        text += "  walls      ";
        for (const Vec2 p : result.walls->corner)
            text += fmt::format("({:.2f}, {:.2f}) ", p.x, p.y);
        text +=
            fmt::format("px; {} within {:.3f} px\n", counted(result.walls->points, "edge point"),
                        result.walls->residual_rms);
    }
    text += camera.scale ? fmt::format("  scale      1 px is {:.5g} {} in the plane of the cell\n",
                                       camera.scale->length, name_of(camera.scale->unit))
                         : "  scale      not known: give option 'pitch'\n";
    if (camera.cell) {
        text += fmt::format("  cell       {:.2f} x {:.2f} px between its walls\n",
                            camera.cell->length.x, camera.cell->length.y);
    }
    text += fmt::format("  correction moves positions by up to {:.2f} px\n", result.largest_shift);
    if (result.views > 0) {
        text += fmt::format("  residual   {:.4f} px per axis (RMS), shown in {}\n",
                            camera.residual_rms, result.picture.string());
    }
    return text;
}

ordered_json facts_of(const CameraJobResult& result) {
    const Camera& camera = result.fit.camera;
    const tracking::Lens& lens = camera.lens;
    ordered_json facts;
    facts["board"] = result.walls                            ? "walls"
                     : result.views == 0                     ? "rectangle"
                     : result.board == BoardKind::chessboard ? "chessboard"
                                                             : "dots";
    facts["pictures"] = result.pictures;
    facts["views"] = result.views;
    facts["points"] = result.fit.residuals.size();
    facts["points_left_out"] = result.fit.dropped;
    facts["width"] = camera.width;
    facts["height"] = camera.height;
    facts["lens"] = {{"focal_px", lens.focal},
                     {"centre_px", {lens.centre.x, lens.centre.y}},
                     {"centre_fitted", result.fit.is_centre_fitted},
                     {"k1", lens.k1},
                     {"k2", lens.k2},
                     {"p1", lens.p1},
                     {"p2", lens.p2}};
    facts["scale"] = nullptr;
    facts["scale_unit"] = nullptr;
    if (camera.scale) {
        facts["scale"] = camera.scale->length;
        facts["scale_unit"] = name_of(camera.scale->unit);
    }
    facts["largest_shift_px"] = result.largest_shift;
    if (result.walls) {
        facts["corners_px"] = ordered_json::array();
        for (const Vec2 p : result.walls->corner) facts["corners_px"].push_back({p.x, p.y});
    }
    facts["residual_px"] =
        result.views > 0 || result.walls ? ordered_json(camera.residual_rms) : ordered_json();
    return facts;
}

}  // namespace

std::string CalibrateCameraCommand::purpose() const {
    return "measure lens and tilt from pictures of a board, for track --camera";
}

Command::Inputs CalibrateCameraCommand::inputs() const {
    return {.placeholder = "BOARD...",
            .meaning =
                "pictures of a chessboard or a dot plate, the first in the plane of the cell; "
                "with --walls or --corners a frame of the film",
            .count = Count::many};
}

std::vector<OptionTable> CalibrateCameraCommand::options() {
    OptionTable own("");
    own.text("output", output_, "camera file to write (TOML); - prints it");
    describe(job_, own);
    return {own};
}

std::string CalibrateCameraCommand::default_output(
    const std::vector<std::filesystem::path>& /*inputs*/) const {
    return "camera.toml";
}

Summary CalibrateCameraCommand::run(Session& session) {
    return pipelines::run_or_discard("calibrate-camera", output_, [&] { return work(session); });
}

Summary CalibrateCameraCommand::work(Session& session) const {
    const bool is_printed = is_standard_output(output_);
    require_output(session, output_);
    if (!is_printed && std::filesystem::path(output_).extension() != ".toml") {
        throw OptionError({.problem = "option 'output' must name a TOML file",
                           .actual = output_,
                           .expected = "a name ending in .toml",
                           .suggestion = {}});
    }
    pipelines::CameraJobOptions job = job_;
    job.output = output_;
    if (session.common.explain) {
        pipelines::plan_camera(job, session);
        return explanation(session.plan);
    }
    if (is_printed) {
        require_no_json_beside(session);
        const StandardOutputFile camera("camera.toml");
        job.output = camera.path().string();
        pipelines::calibrate_camera(job, session);
        session.outputs.clear();
        return {.text = camera.text(), .facts = {}, .is_table = true};
    }
    const CameraJobResult result = pipelines::calibrate_camera(job, session);
    return {.text = words(output_, result), .facts = facts_of(result)};
}

}  // namespace grainfield::app
