#include "app/overlay_job.h"

#include <algorithm>
#include <memory>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "analysis/analysis.h"
#include "core/errors.h"
#include "core/frame_source.h"
#include "core/support/interrupt.h"
#include "core/support/progress.h"
#include "io/frame_files.h"
#include "io/video/colour_video.h"
#include "report/maps/overlay.h"

namespace grainfield::app {

namespace {

namespace fs = std::filesystem;

constexpr int without_film = 1080;  // px of the longer side

// Files of a folder, or the one file.
std::vector<fs::path> files_of(const fs::path& film) {
    if (!fs::is_directory(film)) return {film};
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(film)) {
        if (entry.is_regular_file()) files.push_back(entry.path());
    }
    std::ranges::sort(files);
    return files;
}

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

std::unique_ptr<FrameSource> film_of(Session& session, const SnapshotSource& snapshots,
                                     const RunRecord* record, const OverlayRequest& request) {
    const std::vector<fs::path> files =
        request.film.empty() ? recorded_files(record) : files_of(request.film);
    if (!files.empty()) return io::open_frames(files, {});
    if (!request.film.empty() || snapshots.info().origin == Origin::video) {
        session.plan.warn("the film that was tracked is not there: drawn on white; give --film");
    }
    return nullptr;
}

report::OverlayOptions layout(const SnapshotSource& snapshots, const FrameSource* film,
                              const Box& box, const OverlayRequest& request) {
    report::OverlayOptions options;
    options.trail = static_cast<int>(request.trail);
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

double rate_of(const SnapshotSource& snapshots, const OverlayRequest& request) {
    constexpr double usual = 25;
    constexpr double fastest = 60;  // of films shown as they were taken
    if (request.fps) return *request.fps;
    if (snapshots.info().time_unit != TimeUnit::second) return usual;
    const double filmed = snapshots.info().frame_rate.value_or(usual);
    return filmed > 0 && filmed <= fastest ? filmed : usual;
}

}  // namespace

Summary write_overlay(Session& session, SnapshotSource& snapshots, const RunRecord* record,
                      const OverlayRequest& request, io::Overwrite overwrite) {
    if (snapshots.count() == 0) {
        throw InputError(fmt::format("'{}' holds no frames.", session.inputs.front().string()));
    }
    const auto film = film_of(session, snapshots, record, request);
    const report::OverlayOptions options =
        layout(snapshots, film.get(), snapshots.read(0).box, request);
    const double fps = rate_of(snapshots, request);
    io::ColourVideo video(
        request.output, {.width = options.width, .height = options.height, .fps = fps}, overwrite);
    report::Overlay overlay(options);
    Progress progress("drawing", snapshots.count(), "frames", session.verbosity);
    std::int64_t drawn = 0;
    for (; drawn < snapshots.count() && caught_signal() == 0; ++drawn) {
        const Snapshot snapshot = snapshots.read(drawn);
        Image image;
        if (film != nullptr && snapshot.frame < film->count()) {
            image = film->read(snapshot.frame).image;
        }
        video.write(
            overlay.draw(image, snapshot, analysis::abs_q4(snapshot, options.diameter, {})));
        progress.advance();
    }
    progress.finish();
    if (drawn == 0) throw_if_interrupted("overlay");
    video.finish();
    session.outputs.emplace_back(request.output);
    Summary summary;
    summary.text = fmt::format("{}: {}, {} x {} px, {:g} a second{}\n", request.output,
                               counted(drawn, "frame"), options.width, options.height, fps,
                               film == nullptr ? ", without the film" : "");
    summary.facts["frames"] = drawn;
    summary.facts["frame_rate"] = fps;
    if (caught_signal() != 0) {
        session.plan.warn(fmt::format("interrupted after {} of {} frames, which are kept", drawn,
                                      snapshots.count()));
        summary.signal = caught_signal();
    }
    return summary;
}

}  // namespace grainfield::app
