#include "pipelines/overlay/overlay_job.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/frame_source.h"
#include "core/support/interrupt.h"
#include "core/support/output_file.h"
#include "core/support/progress.h"
#include "io/frame_files.h"
#include "io/h5/trajectory_file.h"
#include "io/input_record.h"
#include "io/joined_films.h"
#include "io/open_snapshots.h"
#include "io/video/colour_video.h"
#include "pipelines/camera/stored_camera.h"
#include "report/maps/overlay.h"

namespace grainfield::pipelines {

namespace {

namespace fs = std::filesystem;

constexpr int without_film = 1080;  // px of the longer side

/// An interrupted run had no time to read its film again.
bool has_checksum(const RunRecord::Input& input) {
    return input.checksum.starts_with("crc32:");
}

bool is_recorded(const fs::path& path, const RunRecord::Input& input) {
    std::error_code unreachable;
    const std::uintmax_t bytes = fs::file_size(path, unreachable);
    if (unreachable || bytes != input.bytes) return false;
    if (!has_checksum(input)) return true;
    try {
        const RunRecord::Input found = io::describe_input(path);
        throw_if_interrupted("overlay");
        return found.checksum == input.checksum;
    } catch (const InputError&) {
        return false;  // not to be read; another one may be
    }
}

[[noreturn]] void refuse_film(const fs::path& tracks, const std::string& missing) {
    throw InputError(
        {.problem = fmt::format("the film of '{}' is not there", tracks.string()),
         .actual = fmt::format("'{}' as it was tracked is in none of the folders above "
                               "it: it is not there, or its content is another",
                               missing),
         .expected = "the film that was tracked, with the recorded checksum",
         .suggestion = "name it with option 'film'; none draws on white"});
}

std::vector<fs::path> recorded_files(const RunRecord* record, const fs::path& tracks,
                                     RunPlan& plan) {
    std::vector<fs::path> files;
    if (record == nullptr || record->command != "track") return files;
    for (const RunRecord::Input& input : record->inputs) {
        files.push_back(find_recorded(input, tracks));
        if (files.back().empty()) refuse_film(tracks, input.name);
    }
    if (!std::ranges::all_of(record->inputs, has_checksum)) {
        plan.warn(
            "the film is known by name and size only: tracking was interrupted before its checksum "
            "was computed");
    }
    return files;
}

std::unique_ptr<FrameSource> film_of(Job& job, const SnapshotSource& snapshots,
                                     const RunRecord* record, const OverlayJobOptions& wanted) {
    if (wanted.film == "none") return nullptr;
    const fs::path& tracks = job.inputs.front();
    const std::vector<fs::path> files = wanted.film.empty()
                                            ? recorded_files(record, tracks, job.plan)
                                            : io::recording_files({wanted.film});
    if (!files.empty()) return io::open_frames(files, {});
    if (snapshots.info().origin == Origin::video) {
        job.plan.warn(
            "the record names no film, as of parts or a live source: drawn on white; option "
            "'film' names it");
    }
    return nullptr;
}

/// "frame 12  0.480 s  127 spheres", ASCII.
std::string caption_of(const Snapshot& snapshot, TimeUnit unit) {
    std::string text = fmt::format("frame {}", snapshot.frame);
    if (unit == TimeUnit::second) {
        text += fmt::format("  {:.3f} s", snapshot.time);
    } else if (unit != TimeUnit::frame) {
        text += fmt::format("  t = {:.4g}", snapshot.time);
    }
    return text + "  " + counted(static_cast<std::int64_t>(snapshot.size()), "sphere");
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

fs::path find_recorded(const RunRecord::Input& input, const fs::path& recorder) {
    const auto is_it = [&](const fs::path& path) { return is_recorded(path, input); };
    fs::path name = input.name;
    if (is_it(name)) return name;
    std::error_code unknown;
    const fs::path home = fs::absolute(recorder, unknown).lexically_normal().parent_path();
    if (is_it(home / name.filename())) return home / name.filename();
    if (name.is_absolute()) return {};
    for (fs::path folder = home;; folder = folder.parent_path()) {
        fs::path there = (folder / name).lexically_normal();
        if (is_it(there)) return there;
        if (folder == folder.parent_path()) return {};
    }
}

void plan_overlay(const OverlayJobOptions& options, Job& job) {
    const auto snapshots = io::open_snapshots(job.inputs.front(), std::nullopt, {});
    job.plan.run("overlay", fmt::format("{} of '{}' to '{}'", counted(snapshots->count(), "frame"),
                                        job.inputs.front().string(), options.output.string()));
}

OverlayJobResult draw_overlay(const OverlayJobOptions& options, Job& job) {
    plan_overlay(options, job);
    const auto snapshots = io::open_snapshots(job.inputs.front(), std::nullopt, {});
    // A name that is refused is refused before a film is read for its checksum.
    { const OutputFile checked(options.output, job.overwrite); }
    if (snapshots->count() == 0) {
        throw InputError(fmt::format("'{}' holds no frames.", job.inputs.front().string()));
    }
    const auto* tracks = dynamic_cast<const io::TrajectoryFile*>(snapshots.get());
    const auto film =
        film_of(job, *snapshots, tracks == nullptr ? nullptr : &tracks->record(), options);
    // A table does not say its unit.
    if (film != nullptr && tracks != nullptr && tracks->info().length_unit != LengthUnit::pixel) {
        throw InputError({.problem = fmt::format("'{}' is not of the film '{}'",
                                                 job.inputs.front().string(), film->name()),
                          .actual = "positions in diameters",
                          .expected = "a trajectory in pixels of that film",
                          .suggestion = "render the trajectory, or draw it without a film"});
    }
    ParticleValues values(options.colour, *snapshots);
    report::OverlayOptions drawn_as =
        layout(*snapshots, film.get(), snapshots->read(0).box, options);
    drawn_as.key = values.key();
    drawn_as.has_strip = true;
    report::Overlay overlay(drawn_as);
    OverlayJobResult result{.frames = 0,
                            .width = overlay.width(),
                            .height = overlay.height(),
                            .fps = rate_of(*snapshots, options),
                            .has_film = film != nullptr};
    io::ColourVideo video(options.output.string(),
                          {.width = result.width, .height = result.height, .fps = result.fps},
                          job.overwrite);
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
        video.write(overlay.draw(image, snapshot, values.next(snapshot),
                                 caption_of(snapshot, snapshots->info().time_unit)));
        progress.advance();
    }
    progress.finish();
    if (result.frames == 0) throw_if_interrupted("overlay");
    video.finish();
    job.outputs.push_back(options.output);
    result.signal = caught_signal();
    if (result.signal != 0) {
        job.plan.warn(WarningCode::interrupted,
                      fmt::format("interrupted after {} of {} frames, which are kept",
                                  result.frames, snapshots->count()));
    }
    return result;
}

}  // namespace grainfield::pipelines
