#include "tracking/tracker_state.h"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "tracking/model/known_models.h"
#include "tracking/tracker.h"

namespace grainfield::tracking {
namespace {

[[noreturn]] void refuse(std::string actual, std::string expected) {
    throw InputError({.problem = "the checkpoint does not fit the film",
                      .actual = std::move(actual),
                      .expected = std::move(expected),
                      .suggestion = "start again from the beginning"});
}

template <class T>
const std::vector<T>& stored(const std::map<std::string, std::vector<T>>& arrays,
                             const std::string& name) {
    const auto found = arrays.find(name);
    if (found == arrays.end()) refuse(fmt::format("it holds no '{}'", name), "");
    return found->second;
}

WarningCode warning_code(std::int64_t number) {
    constexpr auto last = static_cast<std::int64_t>(WarningCode::interrupted);
    if (number < 0 || number > last) {
        refuse(fmt::format("a warning in it has the code {}", number),
               fmt::format("a code from 0 to {}", last));
    }
    return static_cast<WarningCode>(number);
}

}  // namespace

void transfer(NumberArchive& archive, Track& track) {
    auto& [id, frame, position, error, velocity] = track;
    archive.members<Track>(id, frame, position, error, velocity);
}

void transfer(NumberArchive& archive, SubnetCounts& counts) {
    auto& [subnets, largest, largest_pairs, reduced] = counts;
    archive.members<SubnetCounts>(subnets, largest, largest_pairs, reduced);
}

void transfer(NumberArchive& archive, LinkSummary& summary) {
    auto& [linked, started, ended, bridged, bridged_frames, merged, split, consecutive,
           squared_steps, squared_misses, crowded, range, subnets] = summary;
    archive.members<LinkSummary>(linked, started, ended, bridged, bridged_frames, merged, split,
                                 consecutive, squared_steps, squared_misses, crowded, range,
                                 subnets);
}

void transfer(NumberArchive& archive, LinkState& state) {
    auto& [tracks, next_id, frame, drift, motion, summary] = state;
    archive.members<LinkState>(tracks, next_id, frame, drift, motion, summary);
}

void transfer(NumberArchive& archive, Located& found) {
    auto& [position, error, residual, edge_residual, explained, residual_rms, correlation, noise,
           passes, added, removed, coarse_steps, steps, warm, approached, maps_skipped,
           maps_in_part, trials, trials_kept, mended, joint_steps, arrangements, arrangements_taken,
           evidence, doubtful_are_false, fitted, unsettled, rejected, settled_detection,
           detect_seconds, refine_seconds] = found;
    archive.members<Located>(position, error, residual, edge_residual, explained, residual_rms,
                             correlation, noise, passes, added, removed, coarse_steps, steps, warm,
                             approached, maps_skipped, maps_in_part, trials, trials_kept, mended,
                             joint_steps, arrangements, arrangements_taken, evidence,
                             doubtful_are_false, fitted, unsettled, rejected, settled_detection,
                             detect_seconds, refine_seconds);
}

void transfer(NumberArchive& archive, FrameTimes& times) {
    auto& [read, detect, refine, synthesis, link, write, wall] = times;
    archive.members<FrameTimes>(read, detect, refine, synthesis, link, write, wall);
}

void transfer(NumberArchive& archive, FrameWork& work) {
    auto& [frames, discs, disc_updates, joint_steps, gain_maps, trials, trials_kept] = work;
    archive.members<FrameWork>(frames, discs, disc_updates, joint_steps, gain_maps, trials,
                               trials_kept);
}

void transfer(NumberArchive& archive, TrackSummary& summary) {
    auto& [frames, frames_corrupt, frames_missing, particles_mean, residual_rms, noise, step_rms,
           unsettled, rejected, strict_frames, mended, warm_frames, repeated, poor_frames,
           worst_frame, worst_residual, dimmest, brightest, layers, synthesis, ms_per_frame,
           work_per_frame] = summary;
    archive.members<TrackSummary>(
        frames, frames_corrupt, frames_missing, particles_mean, residual_rms, noise, step_rms,
        unsettled, rejected, strict_frames, mended, warm_frames, repeated, poor_frames, worst_frame,
        worst_residual, dimmest, brightest, layers, synthesis, ms_per_frame, work_per_frame);
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
    archive(previous_.synthesised);
    archive(previous_.step_rms);
    light_.transfer(archive);
    first_light_.transfer(archive);
    archive(first_optics_);
    if (bilayer_) bilayer_->transfer(archive);
}

/// What the calibration must give again.
std::vector<double> Tracker::calibration_numbers() const {
    if (!is_calibrated()) return {};
    const ImageModel& model = fitted_model();
    std::vector<double> numbers{static_cast<double>(film_.frame),
                                static_cast<double>(model.polarity),
                                static_cast<double>(number_of(*model.overlap)),
                                model.disc.diameter,
                                model.disc.edge_width,
                                model.dark_level,
                                static_cast<double>(film_.calibration->positions.size()),
                                model.correction.spacing,
                                static_cast<double>(model.binning.factor)};
    numbers.insert(numbers.end(), model.correction.value.begin(), model.correction.value.end());
    if (bias_) {
        const std::vector<double> bias = numbers_of(*bias_);
        numbers.insert(numbers.end(), bias.begin(), bias.end());
    }
    if (kept_optics_) {
        NumberArchive archive;
        FilmOptics kept = *kept_optics_;
        tracking::transfer(archive, kept);
        const std::vector<double> optics = archive.take_numbers();
        numbers.insert(numbers.end(), optics.begin(), optics.end());
    }
    if (options_.camera) {
        const std::vector<double> camera = numbers_of(options_.camera->camera());
        numbers.insert(numbers.end(), camera.begin(), camera.end());
    }
    return numbers;
}

Checkpoint Tracker::checkpoint(Run& run) {
    NumberArchive archive;
    transfer(archive, run);
    Checkpoint checkpoint;
    checkpoint.kind = kTrackStateKind;
    checkpoint.reals["state"] = archive.take_numbers();
    checkpoint.reals["calibration"] = calibration_numbers();
    checkpoint.integers["frames"] = {run.next, source_.count(), span().begin, span().end};
    for (const Warning& warning : plan_.warnings()) {
        checkpoint.texts["warnings"].push_back(warning.text);
        checkpoint.integers["warning codes"].push_back(static_cast<std::int64_t>(warning.code));
    }
    repeated_.save(checkpoint);
    return checkpoint;
}

void Tracker::restore(Run& run, const Checkpoint& checkpoint) {
    if (checkpoint.kind != kTrackStateKind) {
        refuse(fmt::format("it is one of kind '{}'", checkpoint.kind), kTrackStateKind);
    }
    if (stored(checkpoint.reals, "calibration") != calibration_numbers()) {
        refuse("another image model was calibrated on it", "the same film, options and program");
    }
    const std::vector<std::int64_t>& frames = stored(checkpoint.integers, "frames");
    const FrameSpan wanted = span();
    if (frames.size() != 4 || frames[1] != source_.count() || frames[2] != wanted.begin ||
        frames[3] != wanted.end) {
        refuse(frames.size() == 4 ? fmt::format("frames {} to {} of {} were selected", frames[2],
                                                frames[3], frames[1])
                                  : "it does not say which frames were selected",
               fmt::format("{} to {} of {}", wanted.begin, wanted.end, source_.count()));
    }
    NumberArchive archive(stored(checkpoint.reals, "state"));
    transfer(archive, run);
    archive.require_end();
    repeated_.restore(checkpoint);
    const auto texts = checkpoint.texts.find("warnings");
    const auto codes = checkpoint.integers.find("warning codes");
    for (std::size_t i = 0; texts != checkpoint.texts.end() && i < texts->second.size(); ++i) {
        const bool is_coded = codes != checkpoint.integers.end() && i < codes->second.size();
        const auto code = is_coded ? warning_code(codes->second[i]) : WarningCode::other;
        plan_.warn(code, texts->second[i]);
    }
    // Whether the next frame repeats the last one is seen by its pixels.
    if (run.next > 0 && previous_.position == run.next - 1) {
        previous_.counts = source_.read(previous_.position).image;
    }
}

}  // namespace grainfield::tracking
