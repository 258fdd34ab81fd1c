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
    double diameter = 0;              ///< apparent D [px]
    double edge_width = 0;            ///< w [px]
    int binning = 1;                  ///< frames were fitted by blocks of that many pixels a side
    std::string binning_reason = {};  ///< why by these
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
    /// Of the bias of positions; empty with synthesis, which has no such bias.
    std::optional<tracking::BiasDecision> bias;
    int signal = 0;  ///< that ended it early; 0: none

    /// Whether summary.residual_rms was measured.
    bool has_residual() const { return spheres && summary.particles_mean > 0; }
};

}  // namespace grainfield::pipelines
