#include "pipelines/link/link_job.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "core/support/output_file.h"
#include "core/support/progress.h"
#include "io/h5/trajectory_file.h"
#include "pipelines/configuration.h"
#include "pipelines/film/film.h"
#include "pipelines/track/film_part.h"
#include "pipelines/track/kept_tracks.h"
#include "tracking/link/long_tracks.h"
#include "tracking/tracker.h"

namespace grainfield::pipelines {

namespace {

namespace fs = std::filesystem;

/// A part, without its snapshots.
struct Part {
    fs::path path;
    PartRecord own;
    TrajectoryInfo info;
    RunRecord record;
    std::int64_t snapshots = 0;
};

/// "frames 100 to 199": as the source numbers them.
std::string frames_in_words(const PartRecord& film, std::int64_t begin, std::int64_t end) {
    return fmt::format("frames {} to {}{}", film.frame_at(begin), film.frame_at(end - 1),
                       film.film.step > 1 ? fmt::format(" in steps of {}", film.film.step) : "");
}

std::string frames_in_words(const Part& part) {
    return fmt::format("'{}' has {}", part.path.string(),
                       part.own.span.size() == 0
                           ? "no frames"
                           : frames_in_words(part.own, part.own.span.begin, part.own.span.end));
}

Part read_part(const fs::path& path) {
    const io::TrajectoryFile file(path);
    const std::optional<PartRecord> own = part_record(file, path);
    if (!own) {
        throw InputError(
            {.problem = fmt::format("'{}' is not a part of a film", path.string()),
             .actual = fmt::format("a trajectory of {}", counted(file.count(), "frame")),
             .expected = "the output of 'grainfield track --no-link'",
             .suggestion = "track the part again if its tracking was cut off in one frame"});
    }
    return {path, *own, file.info(), file.record(), file.count()};
}

/// The files of the film without their folders, which may differ from machine to machine.
std::vector<std::string> film_of(const Part& part) {
    std::vector<std::string> files;
    for (const RunRecord::Input& input : part.record.inputs) {
        files.push_back(fmt::format("'{}', {} bytes, {}", fs::path(input.name).filename().string(),
                                    input.bytes, input.checksum));
    }
    return files;
}

/// Options on which positions depend, as a part has them.
std::map<std::string, std::string> measured_with(const Part& part) {
    FilmOptions film;
    tracking::TrackOptions tracking;
    std::vector<OptionTable> tables{OptionTable("")};
    describe(film, tables.front());
    for (OptionTable& table : tracking::describe(tracking)) {
        if (table.section() != "link") tables.push_back(std::move(table));
    }
    std::map<std::string, std::string> options;
    for (const auto& [name, value] : part.record.configuration) options[name] = value;
    std::map<std::string, std::string> measured;
    for (const auto& [name, value] : physics_of(tables)) {
        const auto found = options.find(name);
        if (name != "frames" && found != options.end()) measured.insert(*found);
    }
    return measured;
}

[[noreturn]] void refuse(const Part& part, const Part& first, const char* difference,
                         const std::string& actual, const std::string& expected) {
    throw InputError({.problem = fmt::format("'{}' and '{}' differ in {}", part.path.string(),
                                             first.path.string(), difference),
                      .actual = actual,
                      .expected = expected,
                      .suggestion = "track all parts of a film with the same program and options"});
}

void require_same_film(const Part& part, const Part& first) {
    const std::vector<std::string> film = film_of(part);
    const std::vector<std::string> expected = film_of(first);
    if (film.size() != expected.size()) {
        refuse(part, first, "their film", counted(static_cast<std::int64_t>(film.size()), "file"),
               counted(static_cast<std::int64_t>(expected.size()), "file"));
    }
    for (std::size_t i = 0; i < film.size(); ++i) {
        if (film[i] != expected[i]) refuse(part, first, "their film", film[i], expected[i]);
    }
    const auto selection = [](const io::FrameSelection& film_frames) {
        return fmt::format("{} from {} in steps of {}", counted(film_frames.count, "frame"),
                           film_frames.first, film_frames.step);
    };
    if (part.own.film != first.own.film) {
        refuse(part, first, "the frames of the whole film", selection(part.own.film),
               selection(first.own.film));
    }
}

void require_same_measurement(const Part& part, const Part& first) {
    if (part.record.version != first.record.version) {
        refuse(part, first, "the version of the program", part.record.version,
               first.record.version);
    }
    const std::map<std::string, std::string> options = measured_with(part);
    const std::map<std::string, std::string> expected = measured_with(first);
    for (const auto& [name, value] : expected) {
        const auto found = options.find(name);
        if (found != options.end() && found->second == value) continue;
        refuse(part, first, fmt::format("option '{}'", name).c_str(),
               found == options.end() ? "not recorded" : found->second, value);
    }
    if (part.own.calibration != first.own.calibration) {
        refuse(part, first, "their calibration", fmt::format("D = {} px", part.own.disc_diameter),
               fmt::format("D = {} px, and all else alike", first.own.disc_diameter));
    }
}

void require_no_gap(const std::vector<Part>& parts, RunPlan& plan, const LinkJobOptions& options) {
    const auto mind = [&](bool is_allowed, const char* what, const std::string& actual,
                          const std::string& expected, const char* suggestion) {
        if (is_allowed) {
            plan.warn(fmt::format("{}: {}", what, actual));
            return;
        }
        throw InputError(
            {.problem = what, .actual = actual, .expected = expected, .suggestion = suggestion});
    };
    const auto gap = [&](const std::string& who, std::int64_t begin, std::int64_t end) {
        if (begin >= end) return;
        const PartRecord& film = parts.front().own;
        mind(options.allow_gaps, "parts of the film are missing",
             fmt::format("{}, and no part has {}", who, frames_in_words(film, begin, end)),
             frames_in_words(film, 0, film.film.count),
             "track them, or set option 'allow-gaps' to count them as missing frames");
    };
    const Part* last = nullptr;
    for (const Part& part : parts) {
        gap(frames_in_words(part), last == nullptr ? 0 : last->own.span.end, part.own.span.begin);
        if (last != nullptr && part.own.span.begin < last->own.span.end) {
            mind(options.allow_overlaps, "parts overlap",
                 fmt::format("{}, {}", frames_in_words(*last), frames_in_words(part)),
                 "each frame in one part",
                 "leave one out, or set option 'allow-overlaps' to take frames from the first");
        }
        if (last == nullptr || part.own.span.end > last->own.span.end) last = &part;
    }
    gap(frames_in_words(*last), last->own.span.end, last->own.film.count);
}

/// The parts in the order of their frames.
std::vector<Part> checked_parts(const LinkJobOptions& options, Job& job) {
    std::vector<Part> parts;
    for (const fs::path& path : job.inputs) {
        parts.push_back(read_part(path));
        throw_if_interrupted("linking");
    }
    std::ranges::stable_sort(parts, {}, [](const Part& part) { return part.own.span.begin; });
    for (const Part& part : parts) {
        require_same_film(part, parts.front());
        require_same_measurement(part, parts.front());
    }
    require_no_gap(parts, job.plan, options);
    for (const Part& part : parts) {
        for (const Warning& warning : part.record.warnings) job.plan.warn(warning);
    }
    std::int64_t frames = 0;
    for (const Part& part : parts) frames += part.snapshots;
    job.plan.run("link", fmt::format("{} of {}: least squared steps, optimal where spheres compete",
                                     counted(static_cast<std::int64_t>(parts.size()), "part"),
                                     counted(frames, "frame")));
    if (parts.front().own.cell()) {
        job.plan.run("layers", "from the overlaps of spheres, kept by identity");
    } else {
        job.plan.skip("layers", "no height of the cell was given, or the parts have them already",
                      "one graph of overlaps a frame");
    }
    return parts;
}

/// Curves that the parts have in common; each number is the mean over their frames.
std::vector<Curve> mean_curves(const std::vector<Part>& parts) {
    std::vector<Curve> means;
    double frames = 0;
    for (const Part& part : parts) {
        const io::TrajectoryFile file(part.path);
        const auto weight = static_cast<double>(part.snapshots);
        if (weight == 0) continue;
        frames += weight;
        for (const Curve& curve : file.curves()) {
            if (is_of_part(curve)) continue;
            const auto known = std::ranges::find(means, curve.name, &Curve::name);
            if (known == means.end()) {
                means.push_back(curve);
                continue;
            }
            for (std::size_t c = 0; c < known->columns.size() && c < curve.columns.size(); ++c) {
                auto& mean = known->columns[c].values;
                const auto& more = curve.columns[c].values;
                for (std::size_t i = 0; i < std::min(mean.size(), more.size()); ++i) {
                    mean[i] += (more[i] - mean[i]) * weight / frames;
                }
            }
        }
    }
    return means;
}

/// The record says how the parts were measured, too.
void record_parts(const std::vector<Part>& parts, Job& job) {
    const Part& first = parts.front();
    for (const auto& [name, value] : measured_with(first)) {
        job.configuration.emplace_back("part." + name, value);
    }
    for (const std::string& file : film_of(first)) job.configuration.emplace_back("film", file);
}

/// In the pixels of the region that was tracked, as the tracker had them.
Snapshot in_region(Snapshot snapshot, Vec2 origin) {
    for (Vec2& p : snapshot.position) p -= origin;
    snapshot.box.origin -= origin;
    return snapshot;
}

/// Gives snapshots that come in order their identities and layers, as Tracker does.
class PartLinker {
 public:
    PartLinker(const tracking::LinkOptions& options, const PartRecord& film, SnapshotSink& sink)
        : linker_(options, film.disc_diameter),
          long_tracks_(sink, options.minimum_length, options.memory) {
        if (const auto cell = film.cell()) bilayer_.emplace(*cell);
    }

    void link(std::int64_t position, Snapshot snapshot) {
        if (snapshot.size() > 0) {
            snapshot.id = linker_.link(position, snapshot.position, snapshot.position_error);
            if (bilayer_) {
                bilayer_->take(snapshot);
                bilayer_->label(snapshot);
            }
        }
        long_tracks_.write(snapshot);
    }
    void finish() { long_tracks_.finish(); }

    const tracking::Linker& linker() const { return linker_; }
    tracking::Bilayer::Summary layers() const {
        return bilayer_ ? bilayer_->summary() : tracking::Bilayer::Summary{};
    }

 private:
    tracking::Linker linker_;
    tracking::LongTracks long_tracks_;
    std::optional<tracking::Bilayer> bilayer_;
};

}  // namespace

void plan_linking(const LinkJobOptions& options, Job& job) {
    checked_parts(options, job);
}

LinkJobResult link_parts(const LinkJobOptions& options, Job& job) {
    OutputFile output(options.output, job.overwrite);
    const std::vector<Part> parts = checked_parts(options, job);
    const PartRecord& film = parts.front().own;
    record_parts(parts, job);
    KeptTracks tracks(std::move(output), parts.front().info, film.origin, nullptr);
    PartLinker linker(options.link, film, tracks);
    std::int64_t all = 0;
    for (const Part& part : parts) all += part.snapshots;
    Progress progress("linking", all, "frames", job.verbosity);
    std::int64_t next = 0;
    for (const Part& part : parts) {
        io::TrajectoryFile file(part.path);
        for (const Preview& preview : file.previews()) {
            if (part.own.position_of(preview.frame.index) < next) continue;
            tracks.add_preview(preview.frame, in_region(preview.snapshot, film.origin));
        }
        for (std::int64_t i = 0; i < file.count(); ++i) {
            Snapshot snapshot = file.read(i);
            progress.advance();
            const std::int64_t position = part.own.position_of(snapshot.frame);
            if (position < next) continue;
            linker.link(position, in_region(std::move(snapshot), film.origin));
            throw_if_interrupted("linking");
        }
        next = std::max(next, part.own.span.end);
    }
    linker.finish();
    progress.finish();
    LinkJobResult result;
    result.parts = static_cast<std::int64_t>(parts.size());
    result.frames = tracks.frames();
    result.particles_mean = tracks.particles_mean();
    result.links = linker.linker().summary();
    if (result.links.consecutive > 0) {
        result.step_rms =
            std::sqrt(result.links.squared_steps / static_cast<double>(result.links.consecutive));
    }
    result.layers = linker.layers();
    for (const std::string& warning : linker.linker().warnings(film.disc_diameter)) {
        job.plan.warn(warning);
    }
    for (const Curve& curve : mean_curves(parts)) tracks.add_curve(curve);
    tracks.finish(job.record());
    job.outputs.push_back(options.output);
    return result;
}

}  // namespace grainfield::pipelines
