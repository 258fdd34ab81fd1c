#include "pipelines/overlay/overlay_job.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "analysis/order/bond_order.h"
#include "core/errors.h"
#include "core/frame_source.h"
#include "core/support/interrupt.h"
#include "core/support/progress.h"
#include "io/frame_files.h"
#include "io/h5/trajectory_file.h"
#include "io/joined_films.h"
#include "io/open_snapshots.h"
#include "io/video/colour_video.h"
#include "pipelines/camera/stored_camera.h"
#include "report/maps/overlay.h"

namespace grainfield::pipelines {

namespace {

namespace fs = std::filesystem;

constexpr int without_film = 1080;  // px of the longer side

// Files of a folder, or the one file.
std::vector<fs::path> recorded_files(const RunRecord* record) {
    std::vector<fs::path> files;
    if (record == nullptr || record->command != "track") return files;
    for (const RunRecord::Input& input : record->inputs) {
        std::error_code unreachable;
        if (!fs::exists(input.name, unreachable)) return {};
        files.emplace_back(input.name);
    }
    return files;
}

std::unique_ptr<FrameSource> film_of(Job& job, const SnapshotSource& snapshots,
                                     const RunRecord* record, const OverlayJobOptions& wanted) {
    const std::vector<fs::path> files =
        wanted.film.empty() ? recorded_files(record) : io::recording_files({wanted.film});
    if (!files.empty()) return io::open_frames(files, {});
    if (!wanted.film.empty() || snapshots.info().origin == Origin::video) {
        job.plan.warn("the film that was tracked is not there: drawn on white; name the film");
    }
    return nullptr;
}

report::OverlayOptions layout(const SnapshotSource& snapshots, const FrameSource* film,
                              const Box& box, const OverlayJobOptions& wanted) {
    report::OverlayOptions options;
    options.trail = static_cast<int>(wanted.trail);
    options.diameter = snapshots.info().diameter;
    options.y_down = snapshots.info().length_unit == LengthUnit::pixel;
    if (film != nullptr) {
        options.width = film->width();
        options.height = film->height();
        options.x = {-0.5, film->width() - 0.5};
        options.y = {-0.5, film->height() - 0.5};
        return options;
    }
    options.x = {box.origin.x, box.origin.x + box.length.x};
    options.y = {box.origin.y, box.origin.y + box.length.y};
    const double longer = std::max(box.length.x, box.length.y);
    const auto pixels = [&](double side) {
        return std::max(2, static_cast<int>(without_film * side / longer));
    };
    options.width = pixels(box.length.x);
    options.height = pixels(box.length.y);
    return options;
}

double rate_of(const SnapshotSource& snapshots, const OverlayJobOptions& wanted) {
    constexpr double usual = 25;
    constexpr double fastest = 60;  // of films shown as they were taken
    if (wanted.fps) return *wanted.fps;
    if (snapshots.info().time_unit != TimeUnit::second) return usual;
    const double filmed = snapshots.info().frame_rate.value_or(usual);
    return filmed > 0 && filmed <= fastest ? filmed : usual;
}

}  // namespace

void plan_overlay(const OverlayJobOptions& options, Job& job) {
    const auto snapshots = io::open_snapshots(job.inputs.front(), std::nullopt, {});
    job.plan.run("overlay", fmt::format("{} of '{}' to '{}'", counted(snapshots->count(), "frame"),
                                        job.inputs.front().string(), options.output.string()));
}

OverlayJobResult draw_overlay(const OverlayJobOptions& options, Job& job) {
    plan_overlay(options, job);
    const auto snapshots = io::open_snapshots(job.inputs.front(), std::nullopt, {});
    if (snapshots->count() == 0) {
        throw InputError(fmt::format("'{}' holds no frames.", job.inputs.front().string()));
    }
    const auto* tracks = dynamic_cast<const io::TrajectoryFile*>(snapshots.get());
    const auto film =
        film_of(job, *snapshots, tracks == nullptr ? nullptr : &tracks->record(), options);
    const report::OverlayOptions drawn_as =
        layout(*snapshots, film.get(), snapshots->read(0).box, options);
    OverlayJobResult result{.frames = 0,
                            .width = drawn_as.width,
                            .height = drawn_as.height,
                            .fps = rate_of(*snapshots, options),
                            .has_film = film != nullptr};
    io::ColourVideo video(options.output.string(),
                          {.width = result.width, .height = result.height, .fps = result.fps},
                          job.overwrite);
    report::Overlay overlay(drawn_as);
    std::optional<tracking::CorrectedPictures> corrected;
    const auto camera = tracks == nullptr ? std::nullopt : stored_camera(tracks->curves());
    if (film != nullptr && camera) {
        camera->require_size(film->width(), film->height(), film->name());
        corrected.emplace(tracking::CameraMap(*camera), film->width(), film->height());
    }
    Progress progress("drawing", snapshots->count(), "frames", job.verbosity);
    for (; result.frames < snapshots->count() && caught_signal() == 0; ++result.frames) {
        const Snapshot snapshot = snapshots->read(result.frames);
        Image image;
        if (film != nullptr && snapshot.frame < film->count()) {
            image = film->read(snapshot.frame).image;
            if (corrected) image = (*corrected)(image);
        }
        video.write(
            overlay.draw(image, snapshot, analysis::abs_q4(snapshot, drawn_as.diameter, {})));
        progress.advance();
    }
    progress.finish();
    if (result.frames == 0) throw_if_interrupted("overlay");
    video.finish();
    job.outputs.push_back(options.output);
    result.signal = caught_signal();
    if (result.signal != 0) {
        job.plan.warn(fmt::format("interrupted after {} of {} frames, which are kept",
                                  result.frames, snapshots->count()));
    }
    return result;
}

}  // namespace grainfield::pipelines
