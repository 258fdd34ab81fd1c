#include "tracking/track_state.h"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "tracking/tracker.h"

namespace grainfield::tracking {
namespace {

constexpr const char* kKind = "track";

[[noreturn]] void refuse(std::string actual, std::string expected) {
    throw InputError({.problem = "the checkpoint does not fit the film",
                      .actual = std::move(actual),
                      .expected = std::move(expected),
                      .suggestion = "start again without --resume"});
}

template <class T>
const std::vector<T>& stored(const std::map<std::string, std::vector<T>>& arrays,
                             const std::string& name) {
    const auto found = arrays.find(name);
    if (found == arrays.end()) refuse(fmt::format("it holds no '{}'", name), "");
    return found->second;
}

}  // namespace

void transfer(NumberArchive& archive, Track& track) {
    archive(track.id);
    archive(track.frame);
    archive(track.position);
    archive(track.error);
    archive(track.velocity);
}

void transfer(NumberArchive& archive, LinkSummary& summary) {
    archive(summary.linked);
    archive(summary.started);
    archive(summary.ended);
    archive(summary.bridged);
    archive(summary.bridged_frames);
    archive(summary.merged);
    archive(summary.split);
    archive(summary.consecutive);
    archive(summary.squared_steps);
    archive(summary.squared_misses);
    archive(summary.crowded);
    archive(summary.range);
    archive(summary.subnets.subnets);
    archive(summary.subnets.largest);
    archive(summary.subnets.largest_pairs);
    archive(summary.subnets.reduced);
}

void transfer(NumberArchive& archive, LinkState& state) {
    archive(state.tracks);
    archive(state.next_id);
    archive(state.frame);
    archive(state.drift);
    archive(state.motion);
    archive(state.summary);
}

void transfer(NumberArchive& archive, Located& found) {
    archive(found.position);
    archive(found.error);
    archive(found.residual);
    archive(found.explained);
    archive(found.residual_rms);
    archive(found.noise);
    archive(found.passes);
    archive(found.added);
    archive(found.removed);
    archive(found.coarse_steps);
    archive(found.steps);
    archive(found.warm);
    archive(found.approached);
    archive(found.maps_skipped);
    archive(found.maps_in_part);
    archive(found.fitted);
    archive(found.unsettled);
    archive(found.rejected);
    archive(found.settled_detection);
    archive(found.detect_seconds);
    archive(found.refine_seconds);
}

void transfer(NumberArchive& archive, TrackSummary& summary) {
    archive(summary.frames);
    archive(summary.frames_corrupt);
    archive(summary.frames_missing);
    archive(summary.residual_rms);
    archive(summary.unsettled);
    archive(summary.rejected);
    archive(summary.warm_frames);
    archive(summary.repeated);
    archive(summary.poor_frames);
    archive(summary.worst_frame);
    archive(summary.worst_residual);
    archive(summary.dimmest);
    archive(summary.brightest);
    FrameTimes& ms = summary.ms_per_frame;
    for (double* time : {&ms.read, &ms.detect, &ms.refine, &ms.link, &ms.write, &ms.wall})
        archive(*time);
}

void Tracker::transfer(NumberArchive& archive, Run& run) {
    archive(run.next);
    archive(run.particles);
    archive(run.summary);
    LinkState links = run.linker.state();
    archive(links);
    if (archive.restores()) run.linker.restore(std::move(links));
    run.long_tracks.transfer(archive);
    archive(previous_.position);
    archive(previous_.found);
    archive(previous_.step_rms);
    light_.transfer(archive);
    if (bilayer_) bilayer_->transfer(archive);
}

/// What the calibration must give again.
std::vector<double> Tracker::calibration_numbers() const {
    if (!calibration_) return {};
    std::vector<double> numbers{static_cast<double>(calibration_frame_),
                                static_cast<double>(model().polarity),
                                static_cast<double>(model().meeting),
                                model().disc.diameter,
                                model().disc.edge_width,
                                model().dark_level,
                                static_cast<double>(calibration_->positions.size()),
                                model().correction.spacing};
    numbers.insert(numbers.end(), model().correction.value.begin(), model().correction.value.end());
    return numbers;
}

Checkpoint Tracker::checkpoint(Run& run) {
    NumberArchive archive;
    transfer(archive, run);
    Checkpoint checkpoint;
    checkpoint.kind = kKind;
    checkpoint.reals["state"] = archive.take_numbers();
    checkpoint.reals["calibration"] = calibration_numbers();
    checkpoint.integers["frames"] = {run.next, source_.count()};
    for (const Warning& warning : plan_.warnings()) {
        checkpoint.texts["warnings"].push_back(warning.text);
        checkpoint.integers["warning codes"].push_back(static_cast<std::int64_t>(warning.code));
    }
    return checkpoint;
}

void Tracker::restore(Run& run, const Checkpoint& checkpoint) {
    if (checkpoint.kind != kKind) {
        refuse(fmt::format("it is one of kind '{}'", checkpoint.kind), kKind);
    }
    if (stored(checkpoint.reals, "calibration") != calibration_numbers()) {
        refuse("another image model was calibrated on it", "the same film, options and program");
    }
    const std::vector<std::int64_t>& frames = stored(checkpoint.integers, "frames");
    if (frames.size() != 2 || frames[1] != source_.count()) {
        refuse(fmt::format("{} frames were selected", frames.empty() ? 0 : frames.back()),
               fmt::format("{}", source_.count()));
    }
    NumberArchive archive(stored(checkpoint.reals, "state"));
    transfer(archive, run);
    archive.require_end();
    const auto texts = checkpoint.texts.find("warnings");
    const auto codes = checkpoint.integers.find("warning codes");
    for (std::size_t i = 0; texts != checkpoint.texts.end() && i < texts->second.size(); ++i) {
        const bool is_coded = codes != checkpoint.integers.end() && i < codes->second.size();
        const auto code =
            is_coded ? static_cast<WarningCode>(codes->second[i]) : WarningCode::other;
        plan_.warn(code, texts->second[i]);
    }
    // Whether the next frame repeats the last one is seen by its pixels.
    if (run.next > 0 && previous_.position == run.next - 1) {
        previous_.counts = source_.read(previous_.position).image;
    }
}

}  // namespace grainfield::tracking
