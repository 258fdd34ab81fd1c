#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/lab_units.h"
#include "core/trajectory.h"
#include "pipelines/film/film.h"
#include "pipelines/job.h"
#include "pipelines/lab.h"
#include "pipelines/resumable.h"
#include "tracking/tracker.h"

namespace grainfield::pipelines {

/// What tracking one film is asked for; the film is the inputs of the job.
struct TrackJobOptions {
    std::filesystem::path output;
    FilmOptions film;
    std::int64_t previews = 3;  ///< frames kept in the output to look at
    ResumeOptions resume{.resume = false, .every = std::chrono::minutes(1)};
    tracking::TrackOptions tracking;
    LabUnits lab;                  ///< stored with the trajectory
    std::string camera;            ///< file of lens and tilt; empty: positions as seen
    std::string calibration;       ///< file of a kept calibration to use; empty: calibrate
    std::string save_calibration;  ///< file to keep the calibration in; empty: not kept
};

/// The spheres as the calibrated image model has them.
struct SphereImage {
    tracking::Polarity polarity = tracking::Polarity::dark;
    double diameter = 0;    ///< apparent D [px]
    double edge_width = 0;  ///< w [px]
};

/// What tracking, or the part of it until a signal, did.
struct TrackJobResult {
    tracking::TrackSummary summary;
    std::optional<SphereImage> spheres;            ///< empty: the tracker could not calibrate
    std::vector<tracking::SizeCandidate> weighed;  ///< of size and polarity, on one frame
    TrajectoryInfo info;                           ///< as the file has it
    RateSource rate_source = RateSource::unknown;  ///< of the frame rate
    LabUnits lab;                                  ///< as given, or as the camera says
    std::optional<tracking::Camera> camera;        ///< positions were corrected with
    int signal = 0;                                ///< that ended it early; 0: none

    /// Whether summary.residual_rms was measured.
    bool has_residual() const { return spheres && summary.particles_mean > 0; }
};

/// Says in the plan what track_film would do; calibrates for it. Throws what track_film throws.
void plan_tracking(const TrackJobOptions& options, Job& job);

/// Tracks the film and writes the trajectory. Of a part (FilmOptions::is_part) the file has no
/// identities, but what link_parts needs (PartRecord). At a signal the frames done so far are a
/// complete output, and a checkpoint beside it is what `resume` goes on from (Resumable, log
/// ".snapshots"): the file in the end is that of a run that was not stopped, byte by byte but for
/// the wall time. With a camera, positions, box and previews are corrected ones, and where its
/// scale is known the diameter of the spheres follows from it, or the spheres' millimetres. A frame
/// that takes longer than a second is given up at a signal. Throws OptionError, InputError,
/// OutputError; InputError too if no frame says what its spheres are, or no frame holds one.
TrackJobResult track_film(const TrackJobOptions& options, Job& job);

}  // namespace grainfield::pipelines
