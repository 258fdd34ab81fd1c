// What Tracker makes of fitted frames: snapshots with errors, layers and identities.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <fmt/format.h>

#include "tracking/camera/size_misfit.h"
#include "tracking/run_clock.h"
#include "tracking/synthesis/corrected_positions.h"
#include "tracking/tracker.h"

namespace grainfield::tracking {
namespace {

constexpr double kMostWithoutRoom = 0.006;  // of the spheres (share_without_room)

/// Leaves out the spheres beside the box; `evidence` has one entry each, too.
void keep_within(const Box& box, Snapshot& snapshot, std::vector<double>& evidence) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < snapshot.size(); ++i) {
        if (!box.contains(snapshot.position[i])) continue;
        snapshot.position[kept] = snapshot.position[i];
        snapshot.position_error[kept] = snapshot.position_error[i];
        snapshot.quality[kept] = snapshot.quality[i];
        evidence[kept] = evidence[i];
        ++kept;
    }
    snapshot.position.resize(kept);
    snapshot.position_error.resize(kept);
    snapshot.quality.resize(kept);
    evidence.resize(kept);
}

}  // namespace

Snapshot Tracker::snapshot_of(const Job& job, Run& run) {
    Snapshot snapshot;
    snapshot.frame = job.frame.index;
    snapshot.time = job.frame.time;
    snapshot.box = box_;
    if (!is_calibrated()) return snapshot;
    if (!job.blank.empty()) {
        repeated_.add(job.frame.index, job.blank);
        return snapshot;
    }
    TrackSummary& summary = run.summary;
    const Located& found = job.found;
    if (job.is_repeated) {
        ++summary.repeated;
    } else {
        summary.warm_frames += job.is_warm;
        summary.dimmest = std::min(summary.dimmest, job.light.span);
        summary.brightest = std::max(summary.brightest, job.light.span);
        add(found, summary.work_per_frame);
        summary.ms_per_frame.detect += job.ms.detect;
        summary.ms_per_frame.refine += job.ms.refine;
        summary.ms_per_frame.synthesis += job.ms.synthesis;
    }
    judge(found, job.frame, summary, repeated_, plan_);
    report(job, snapshot, summary);
    if (!options_.part) link(job, run, snapshot);
    if (bilayer_) summary.layers = bilayer_->summary();
    return snapshot;
}

/// Positions, errors and what else is known of each sphere.
void Tracker::report(const Job& job, Snapshot& snapshot, TrackSummary& summary) {
    if (job.synthesised) {
        snapshot.box.height = synthesis_->cell_height();
        synthesis_->report(*job.synthesised, options_.detection.border * model().disc.diameter,
                           snapshot);
        if (!job.is_repeated) add(*job.synthesised, job.frame.index, summary.synthesis);
        return;
    }
    const std::optional<Located> unbinned =
        binning().is_none() ? std::nullopt : std::optional(in_frame(job.found, binning()));
    const Located& found = unbinned ? *unbinned : job.found;
    snapshot.position = found.position;
    snapshot.quality = found.residual;
    // Misfit of discs that the camera sees larger or smaller does not displace them.
    snapshot.position_error =
        options_.camera && !bias_
            ? standard_errors(found, size_misfit(*options_.camera, found.position,
                                                 found.edge_residual, model().disc.diameter))
            : standard_errors(found);
    if (!options_.camera) {
        if (summary.frames == 0) check_room(snapshot);
        if (bilayer_) bilayer_->admit(snapshot, found.explained);
        return;
    }
    options_.camera->correct(snapshot);
    std::vector<double> explained = found.explained;
    keep_within(box_, snapshot, explained);
    if (bilayer_) bilayer_->admit(snapshot, explained);
}

/// Hard spheres lie in one another if their diameter is given too large, or the cell too low.
void Tracker::check_room(const Snapshot& snapshot) const {
    const DetectionOptions& options = options_.detection;
    if (!options.sphere_diameter || snapshot.size() == 0) return;
    const SphereCell cell{.diameter = *options.sphere_diameter,
                          .height = options.cell_height,
                          .camera_distance = options_.layers.camera_distance.value_or(0)};
    const OverlapGraph graph(cell, snapshot.position, snapshot.position_error);
    const double share = share_without_room(graph);
    if (share <= kMostWithoutRoom) return;
    plan_.warn(fmt::format(
        "{:.1f} % of the spheres of frame {} have no room between plates {:g} a apart{}, and "
        "hardly "
        "any should: is track.sphere-diameter ({:g} px) too large, or layers.height too small? "
        "Standard errors and layers then mean little.",
        100 * share, snapshot.frame, cell.height, options_.layers.height ? "" : " (not given)",
        cell.diameter));
}

void Tracker::link(const Job& job, Run& run, Snapshot& snapshot) {
    TrackSummary& summary = run.summary;
    const auto begin = RunClock::now();
    snapshot.id = run.linker.link(job.position, snapshot.position, snapshot.position_error);
    // Without spheres nothing contradicts what is known of the layers.
    if (bilayer_ && snapshot.size() > 0) bilayer_->label(snapshot);
    summary.ms_per_frame.link += milliseconds_since(begin);
}

/// Links and writes what was found, and keeps it for the frames to come.
void Tracker::finish(Job& job, Run& run, const EachFrame& each_frame) {
    TrackSummary& summary = run.summary;
    if (job.frame.status != FrameStatus::ok) {
        ++(job.frame.status == FrameStatus::corrupt ? summary.frames_corrupt
                                                    : summary.frames_missing);
        repeated_.add(job.frame.index, job.frame.message);
        return;
    }
    const Snapshot snapshot = snapshot_of(job, run);
    run.particles += static_cast<double>(snapshot.size());
    ++summary.frames;
    const auto begin = RunClock::now();
    run.long_tracks.write(snapshot);
    summary.ms_per_frame.write += milliseconds_since(begin);
    if (each_frame) each_frame(job.frame, snapshot, job.position);
    keep(job);
}

}  // namespace grainfield::tracking
