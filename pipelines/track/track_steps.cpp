#include "pipelines/track/track_steps.h"

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/output_file.h"
#include "pipelines/analyze/lengths.h"
#include "pipelines/camera/camera_file.h"
#include "pipelines/camera/stored_camera.h"
#include "pipelines/track/calibration_file.h"
#include "pipelines/track/stored_bias.h"
#include "pipelines/track/stored_binning.h"

namespace grainfield::pipelines {

using tracking::Tracker;

namespace {

/// The optics that synthesis found, and how well rendering and image agree with them.
Curve synthesis_curve(const tracking::SynthesisSummary& found) {
    const tracking::MirrorOptics& optics = found.optics;
    const tracking::OpticsErrors& error = found.optics_error;
    return {"synthesis",
            "Mirror spheres as synthesis sees them",
            {{"reflectivity", "-", "Reflectivity F0", {optics.reflectivity}},
             {"reflectivity_std", "-", "Its standard error", {error.reflectivity}},
             {"blur", "a", "Blur (standard deviation)", {optics.blur}},
             {"blur_std", "a", "Its standard error", {error.blur}},
             {"ambient", "-", "Radiance beside the panel", {optics.ambient}},
             {"ambient_std", "-", "Its standard error", {error.ambient}},
             {"grazing", "-", "Sine of the least angle that meets the panel", {optics.grazing}},
             {"grazing_std", "-", "Its standard error", {error.grazing}},
             {"camera_distance", "a", "Distance of the camera (0: telecentric)", {optics.distance}},
             {"residual_before",
              "-",
              "Residual at the start (RMS, of the contrast)",
              {found.mean_before()}},
             {"residual", "-", "Residual (RMS, of the contrast)", {found.mean_after()}}},
            {}};
}

/// The camera that is named, or that the kept calibration holds.
std::optional<tracking::Camera> camera_of(const TrackJobOptions& options,
                                          const std::optional<tracking::KeptCalibration>& kept) {
    const std::optional<tracking::Camera> held = kept ? kept->camera : std::nullopt;
    if (options.camera.empty()) return held;
    tracking::Camera camera = read_camera(options.camera);
    if (held && *held != camera) {
        throw OptionError({.problem = "two cameras are given",
                           .actual = fmt::format("'{}' and the one that '{}' holds differ",
                                                 options.camera, options.calibration),
                           .expected = "one camera",
                           .suggestion = "leave out option 'camera', or calibrate again"});
    }
    return camera;
}

}  // namespace

TracksInWork::TracksInWork(Job& job, const Resumable::Identity& identity,
                           const TrackJobOptions& options)
    : resumable(job, identity, options.resume),
      output((resumable.require_free(), OutputFile(options.output, resumable.overwrite()))),
      last_act(job, resumable) {
    deadline.emplace([this](int) { return last_act(); });
}

tracking::TrackOptions tracking_of(const TrackJobOptions& options, const Job& job,
                                   std::optional<tracking::Camera>& camera) {
    tracking::TrackOptions tracking = options.tracking;
    tracking.threads = job.threads;
    tracking.verbosity = job.verbosity;
    tracking.keeps = !options.save_calibration.empty();
    if (!options.calibration.empty()) tracking.kept = read_calibration(options.calibration);
    camera = camera_of(options, tracking.kept);
    const auto diameter = camera ? camera->diameter_px(options.lab.sphere_mm) : std::nullopt;
    if (diameter && tracking.sphere_diameter) {
        require_agreement("diameter of the spheres in px", "track.sphere-diameter",
                          *tracking.sphere_diameter, "scale of the camera", *diameter);
    }
    if (diameter) tracking.sphere_diameter = diameter;
    return tracking;
}

LabUnits lab_of(const LabUnits& given, const std::optional<tracking::Camera>& camera,
                const Film& film, const TrajectoryInfo& info) {
    LabUnits lab = given;
    const bool knows_mm = camera && camera->scale && camera->scale->unit == tracking::PlaneUnit::mm;
    // The apparent disc is no true diameter.
    if (lab.sphere_mm || info.diameter_origin == DiameterOrigin::apparent) return lab;
    if (knows_mm) lab.sphere_mm = info.diameter * camera->scale->length;
    if (!camera && film.pixel_mm) lab.sphere_mm = info.diameter * *film.pixel_mm;
    return lab;
}

void complete(tracking::TrackOptions& tracking, const Film& film,
              const std::optional<tracking::Camera>& camera) {
    tracking.visible = film.visible;
    if (film.part) tracking.part = film.part->span;
    if (!camera) return;
    camera->require_size(film.whole_width, film.whole_height, film.frames->name());
    tracking.camera.emplace(*camera, film.origin);
}

std::optional<SphereImage> spheres_of(const Tracker& tracker) {
    if (!tracker.is_calibrated()) return std::nullopt;
    const tracking::ImageModel& model = tracker.model();
    return SphereImage{model.polarity, model.disc.diameter, model.disc.edge_width,
                       tracker.binning().factor, tracker.binning_reason()};
}

void warn_of_units(const tracking::TrackOptions& options, const FrameSource& frames,
                   const Tracker& tracker, RunPlan& plan) {
    if (frames.count() > 1 && !frames.frame_rate()) {
        plan.warn("times are in frames: the frame rate is not known; give option 'fps'");
    }
    if (options.sphere_diameter || !tracker.is_calibrated()) return;
    plan.warn(WarningCode::apparent_diameter,
              fmt::format("lengths are in apparent disc diameters D = {:.3f} px; give the true "
                          "diameter a, track.sphere-diameter (of polished steel D is about 0.88 a)",
                          tracker.model().disc.diameter));
}

void require_calibration(const Tracker& tracker, const FrameSource& frames) {
    if (tracker.is_calibrated()) return;
    throw InputError({.problem = fmt::format("no spheres to track in '{}'", frames.name()),
                      .actual = tracker.weighed().empty()
                                    ? std::string("nothing like a disc in the frames looked at")
                                    : "of the image " + tracking::in_words(tracker.weighed()),
                      .expected = "spheres of one size, clearer than any other reading",
                      .suggestion = "say which they are: calibrate.disc-diameter, "
                                    "calibrate.polarity; tune shows what was weighed"});
}

RateSource rate_source(const TrackJobOptions& options, const FrameSource& frames) {
    if (options.film.fps) return RateSource::given;
    return frames.frame_rate() ? RateSource::file : RateSource::unknown;
}

void refuse_without_spheres(const TrackJobResult& result, std::int64_t frames) {
    throw InputError({.problem = fmt::format("no spheres in any of {}", counted(frames, "frame")),
                      .actual = fmt::format("dark or bright discs of D = {:.2f} px were looked for",
                                            result.spheres->diameter),
                      .expected = "spheres, in tracks of link.minimum-length frames or more",
                      .suggestion = "look at the film with tune"});
}

void add_curves(const TrackJobResult& result, KeptTracks& tracks) {
    const tracking::TrackSummary& summary = result.summary;
    if (result.has_residual()) {
        // Of the model that positions come from: verdicts are of what is in the file.
        const double residual =
            summary.synthesis.frames > 0 ? summary.synthesis.mean_after() : summary.residual_rms;
        tracks.add_curve(calibration_curve(result.spheres->diameter, result.spheres->edge_width,
                                           residual, summary.noise));
    }
    if (const auto units = curve_of(result.lab)) tracks.add_curve(*units);
    if (result.camera) tracks.add_curve(curve_of(*result.camera));
    if (result.spheres) tracks.add_curve(binning_curve(result.spheres->binning));
    if (result.bias) tracks.add_curve(curve_of(*result.bias));
    if (summary.synthesis.frames > 0) tracks.add_curve(synthesis_curve(summary.synthesis));
}

void save_calibration(const std::string& path, tracking::KeptCalibration kept,
                      const std::optional<tracking::Camera>& camera, Overwrite overwrite,
                      Job& job) {
    kept.camera = camera;
    write_file(path, text_of(kept), overwrite);
    job.outputs.emplace_back(path);
}

}  // namespace grainfield::pipelines
