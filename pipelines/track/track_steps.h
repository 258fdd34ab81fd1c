#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "pipelines/interrupt_deadline.h"
#include "pipelines/resumable.h"
#include "pipelines/track/kept_tracks.h"
#include "pipelines/track/track_values.h"

// What tracking a stored film and a live source have in common.

namespace grainfield::pipelines {

/// What a long job holds while it writes tracks. A signal that finds it stuck in one frame leaves
/// what is written. Members outlive those below them: the deadline is the first to go.
struct TracksInWork {
    /// Claims the output. Throws OutputError as OutputFile does, and as Resumable::require_free.
    TracksInWork(Job& job, const Resumable::Identity& identity, const TrackJobOptions& options);

    Resumable resumable;
    OutputFile output;
    std::optional<io::SnapshotLog> log;
    std::optional<KeptTracks> tracks;
    LastAct last_act;
    std::optional<InterruptDeadline> deadline;
};

/// The options of the tracker, with the calibration that is kept and, where the camera's scale
/// tells it, the diameter of the spheres. `camera`: the one that is named or kept. Throws
/// OptionError, InputError.
tracking::TrackOptions tracking_of(const TrackJobOptions& options, const Job& job,
                                   std::optional<tracking::Camera>& camera);

/// What the film adds to the options of the tracker. Throws InputError if the camera is for frames
/// of another size.
void complete(tracking::TrackOptions& tracking, const Film& film,
              const std::optional<tracking::Camera>& camera);

/// Lengths of the lab as given, or as the camera's scale has them, or the file's size of a pixel
/// where no camera moves them. An apparent diameter gives none.
LabUnits lab_of(const LabUnits& given, const std::optional<tracking::Camera>& camera,
                const Film& film, const TrajectoryInfo& info);

/// Empty if the tracker could not calibrate.
std::optional<SphereImage> spheres_of(const tracking::Tracker& tracker);

RateSource rate_source(const TrackJobOptions& options, const FrameSource& frames);

/// Warns of times in frames and lengths in apparent diameters.
void warn_of_units(const tracking::TrackOptions& options, const FrameSource& frames,
                   const tracking::Tracker& tracker, RunPlan& plan);

/// Throws InputError if the film cannot be tracked without more said of it. The warnings say what
/// was weighed.
void require_calibration(const tracking::Tracker& tracker, const FrameSource& frames);

/// Throws the InputError of frames without any sphere.
[[noreturn]] void refuse_without_spheres(const TrackJobResult& result, std::int64_t frames);

/// Calibration, units, camera and optics, to go with the trajectory.
void add_curves(const TrackJobResult& result, KeptTracks& tracks);

/// Writes the file of `track --save-calibration`. Throws OutputError.
void save_calibration(const std::string& path, tracking::KeptCalibration kept,
                      const std::optional<tracking::Camera>& camera, Overwrite overwrite, Job& job);

}  // namespace grainfield::pipelines
