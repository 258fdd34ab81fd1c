#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/frame_source.h"
#include "core/run_plan.h"
#include "core/support/checkpoint.h"
#include "core/support/number_archive.h"
#include "core/support/progress.h"
#include "core/trajectory.h"
#include "tracking/bias_decision.h"
#include "tracking/calibrate/film_calibration.h"
#include "tracking/calibrate/illumination.h"
#include "tracking/calibrate/kept_calibration.h"
#include "tracking/layers/bilayer.h"
#include "tracking/link/linker.h"
#include "tracking/link/long_tracks.h"
#include "tracking/locate.h"
#include "tracking/model/image_model.h"
#include "tracking/repeated_warnings.h"
#include "tracking/synthesis/bias_correction.h"
#include "tracking/synthesis/film_synthesis.h"
#include "tracking/track_options.h"
#include "tracking/track_summary.h"

namespace grainfield::tracking {

/// What a saved run of the tracker calls itself (Checkpoint::kind), with the version of what it
/// holds.
inline constexpr const char* kTrackStateKind = "track 8";

/// How a long run is saved now and then, and taken up again.
struct TrackResumption {
    /// The state to go on from; the sink holds the snapshots that were written before it. Throws
    /// InputError if the film, its calibration or the options are others.
    const Checkpoint* from = nullptr;
    std::function<bool()> is_due = {};            ///< asked after each frame
    std::function<void(Checkpoint&&)> save = {};  ///< also when a signal ends the run early
    /// Frames that take longer are saved each [ms]: a signal does not wait for the end of one.
    double slow = 1000;
};

/// Frames in, linked snapshots out: calibrates the image model on the first usable frame, then
/// locates every sphere of every frame and gives it its identity through time.
///
/// The first frame is fitted alone, then two at a time, side by side. Both start from the spheres
/// of the frame before the two (warm), one or two frames ago. They start cold if these are expected
/// to have moved by more than D/4, or if more frames are missing between them. Refinement continues
/// from there. New and lost spheres are searched only where the residual is large enough. A frame
/// that repeats the one before costs nothing. The light of each frame is followed
/// (IlluminationFollower).
///
/// Every `stretch` frames this begins afresh: a cold search, and the light as the first frame left
/// it. What is found in a stretch so depends on no other stretch. A part of the film is measured
/// alone with the same result: the calibration is that of the whole film, its first usable frame is
/// fitted for the light, then all frames from the beginning of the stretch that holds the first
/// one. Those before `part.begin` are not passed on. Snapshots of a part have no identities, and no
/// layers from overlaps: these follow from identities.
///
/// With a correction of the bias, the general one, one learned on the frame calibrated on or kept
/// with the calibration (bias_of_film), positions and errors are corrected as soon as a frame is
/// fitted; with synthesis, the discs that it begins with. The next frame starts from those of the
/// fit.
///
/// With synthesis, positions, heights and layers are those of FilmSynthesis, frame by frame, and
/// the next frame starts from them. Else, where the height of the cell is given, spheres without
/// room between the plates are left out. The others get the layer that their overlaps imply
/// (Bilayer), up to a flip of each cluster.
///
/// Frames may be fitted by blocks of pixels (model_of_film). Positions are in pixels of the source.
/// With a camera they are corrected as soon as a frame is fitted, so that layers and identities
/// follow from corrected ones. Those outside of CameraMap::box, which becomes the box, are left
/// out. Fitting itself knows nothing of it. Three frames are in memory at a time. Results do not
/// depend on the number of threads: frames are fitted in twos on one thread as well, or alone where
/// the second of two would begin cold.
class Tracker {
 public:
    /// Calibrates; what was decided goes into `plan`. The source must outlive the tracker. A source
    /// without any usable frame gives a tracker that writes empty snapshots, with warnings. Throws
    /// OptionError if the height of the cell, or synthesis, is asked for without the true diameter
    /// of the spheres, if synthesis or a correction of the bias is asked for with a mask, bright
    /// spheres or a camera, or both of them are, or if
    /// a kept calibration comes with options that estimate or give what it holds; InputError if it
    /// is of frames of another size, or the camera leaves no box.
    Tracker(FrameSource& source, const TrackOptions& options, RunPlan& plan);

    Tracker(const Tracker&) = delete;
    Tracker& operator=(const Tracker&) = delete;

    bool is_calibrated() const { return film_.calibration.has_value(); }
    /// Call only if is_calibrated().
    /// Of pixels, whatever frames are fitted on.
    const ImageModel& model() const { return *model_; }
    /// How frames are seen where they are fitted. Call only if is_calibrated().
    Binning binning() const { return fitted_model().binning; }
    /// Why frames are fitted by these blocks, or by pixels.
    const std::string& binning_reason() const { return binning_reason_; }
    /// Tells calibrations apart: the frame used and the numbers of the model. Empty without one.
    std::vector<double> calibration_numbers() const;
    /// All that are looked at: the part's, and those of its first stretch before it.
    FrameSpan frames_to_fit() const;
    TrajectoryInfo info() const;
    /// What calibration weighed, on the frame at weighed_at() among those selected; the frame that
    /// was tried last where none could be calibrated on. Empty: nothing disc-shaped was seen.
    const std::vector<SizeCandidate>& weighed() const { return film_.weighed; }
    std::int64_t weighed_at() const { return film_.weighed_at; }
    /// What was decided of the bias of the discs; with synthesis, of those that it begins with.
    const BiasDecision& bias_decision() const { return bias_decision_; }
    /// What a film with synthesis leaves to others, once its first frame has been; else what the
    /// calibration that is used holds. Empty where the factors of its errors were not learned.
    std::optional<FilmOptics> optics() const {
        if (first_optics_ && first_optics_->error_scale.spheres > 0) return first_optics_;
        return options_.kept ? options_.kept->optics : std::nullopt;
    }
    /// What films to come need to be measured alike, from the frame calibrated on, and after a run
    /// with synthesis its optics. Call only if is_calibrated().
    KeptCalibration to_keep() {
        KeptCalibration kept = tracking::to_keep(film_, source_, options_.visible, threads_);
        if (bias_ && !bias_->is_general()) kept.bias = bias_;
        kept.optics = optics();
        return kept;
    }

    /// Told of each frame that was tracked, in order, and its position among those selected.
    using EachFrame = std::function<void(const Frame&, const Snapshot&, std::int64_t position)>;

    /// Tracks all frames. Corrupt and missing frames leave a gap. Stops early, keeping what was
    /// done, when an interrupt was caught (core/support/interrupt.h). A run that was saved, and a
    /// new tracker that continues from there, give the same snapshots as one that was not.
    TrackSummary run(SnapshotSink& sink, Progress& progress, const EachFrame& each_frame = {},
                     const TrackResumption& resumption = {});

 private:
    /// What the frames before leave for the next.
    struct Previous {
        std::int64_t position = -2;  ///< among the frames selected
        Image counts;
        Located found;  ///< in the frame as it is fitted, like the next but one
        std::optional<SynthesisedFrame> synthesised = {};
        double step_rms = 0;  ///< RMS step to its discs from those before [px]; 0: unknown
    };

    /// What is carried from frame to frame besides the above.
    struct Run {
        Linker linker;
        LongTracks long_tracks;
        TrackSummary summary;
        double particles = 0;
        std::int64_t next = 0;  ///< position of the next frame
    };
    Checkpoint checkpoint(Run& run);
    void restore(Run& run, const Checkpoint& checkpoint);
    void transfer(NumberArchive& archive, Run& run);
    FrameSpan span() const;

    /// What a frame is fitted with; frames side by side have one each.
    struct Lane {
        Locator locator;
        IlluminationFollower illumination;
        Image blocks = {};                   ///< the frame, where it is binned; memory is kept
        Image darkness = {}, residual = {};  ///< of the frame that is corrected
    };
    /// A frame on its way.
    struct Job {
        Frame frame;
        std::int64_t position = 0;  ///< among those selected: frames left out are not missing
        std::string blank;          ///< why there is nothing to fit; empty: there is
        bool is_repeated = false;   ///< of the frame before: `found` is that one's
        bool is_warm = false;
        Located found;            ///< in the frame as it is fitted
        std::vector<Vec2> discs;  ///< that synthesis begins with; empty without it [px]
        std::optional<SynthesisedFrame> synthesised = {};
        Illumination light;
        FrameTimes ms;

        bool is_usable() const { return frame.status == FrameStatus::ok && blank.empty(); }
    };
    const ImageModel& fitted_model() const { return film_.calibration->model; }
    bool is_far_for_two() const;
    std::vector<Job> read(Run& run);
    void fit(std::vector<Job>& jobs);
    void fit(Job& job, Lane& lane) const;
    void synthesise(std::vector<Job>& jobs);
    std::vector<Vec2> start_for(const Job& job) const;
    void find_first_light();
    void begin_stretch();
    void finish(Job& job, Run& run, const EachFrame& each_frame);
    void keep(Job& job);
    Snapshot snapshot_of(const Job& job, Run& run);
    void report(const Job& job, Snapshot& snapshot, TrackSummary& summary);
    void check_room(const Snapshot& snapshot) const;
    void link(const Job& job, Run& run, Snapshot& snapshot);
    void correct(Job& job, const Image& counts, Lane& lane) const;

    FrameSource& source_;
    TrackOptions options_;
    RunPlan& plan_;
    int threads_;
    FilmCalibration film_;             ///< of frames as they are fitted
    std::optional<ImageModel> model_;  ///< the same of pixels
    /// As they hold for frames that are fitted, which may be binned.
    DetectionOptions fit_detection_;
    RefinementOptions fit_refinement_;
    VisiblePixels fit_visible_;
    Box box_;                    ///< of all snapshots, without its height
    RepeatedWarnings repeated_;  ///< of the frames tracked so far
    std::vector<Lane> lanes_;
    IlluminationFollower::State light_, first_light_;
    std::optional<FilmOptics> kept_optics_;   ///< of the calibration that is used
    std::optional<FilmOptics> first_optics_;  ///< kept ones, or of the first frame
    Previous previous_;
    std::optional<Bilayer> bilayer_;
    std::optional<FilmSynthesis> synthesis_;
    std::optional<BiasCorrection> bias_;
    BiasDecision bias_decision_;
    std::string binning_reason_;
};

}  // namespace grainfield::tracking
