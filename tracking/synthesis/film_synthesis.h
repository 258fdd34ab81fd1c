#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/frame.h"
#include "core/run_plan.h"
#include "core/snapshot.h"
#include "core/support/number_archive.h"
#include "core/vec2.h"
#include "tracking/model/image_model.h"
#include "tracking/synthesis/mirror_optics.h"
#include "tracking/synthesis/synthesis.h"

namespace grainfield::tracking {

/// What the first frame of a film leaves to the others, and a kept calibration to other films.
struct FilmOptics {
    double diameter = 0;  ///< true diameter a [px]
    double height = 0;    ///< of the cell [a]
    MirrorOptics optics;
    OpticsErrors error;
    ErrorScale error_scale;

    friend bool operator==(const FilmOptics&, const FilmOptics&) = default;
};

/// What synthesis found in one frame; all columns have one entry a sphere.
struct SynthesisedFrame {
    std::vector<Vec2> position;    ///< those cut by the border included [px]
    std::vector<Vec2> error;       ///< standard errors [px]
    std::vector<double> z;         ///< of the centre above the lowest place [a]
    std::vector<double> z_error;   ///< [a]
    std::vector<double> residual;  ///< local RMS of image − rendering [contrast]
    MirrorOptics optics;
    OpticsErrors optics_error;
    ErrorScale error_scale;
    double residual_before = 0, residual_rms = 0;  ///< of the whole frame [contrast]
    double unexplained = 0;  ///< the part of residual_rms that is no noise [contrast]
    std::int64_t added = 0, removed = 0, lifted = 0, doubtful = 0;
};

/// A rendering that leaves more of the contrast than this, white noise apart, is called into doubt.
/// Chosen between what right and wrong descriptions of ray-traced frames leave; the figures are in
/// bench/results/synthesis.md.
inline constexpr double kMostUnexplained = 0.03;

/// A height with a larger standard error counts as unknown, here and in the analysis [a].
inline constexpr double kMostHeightError = 0.2;

/// All frames together.
struct SynthesisSummary {
    std::int64_t frames = 0;
    std::int64_t spheres = 0, doubtful = 0;
    std::int64_t heights_known = 0;  ///< spheres whose standard error is at most kMostHeightError
    std::int64_t added = 0, removed = 0, lifted = 0;
    double residual_before = 0, residual_rms = 0;  ///< sums over frames [contrast]
    std::int64_t doubtful_frames = 0;              ///< with more than 1 % of their spheres doubtful
    std::int64_t risen_frames = 0;                 ///< whose residual did not fall
    std::int64_t unexplained_frames = 0;           ///< that leave more than kMostUnexplained
    double most_unexplained = 0;                   ///< [contrast]
    std::int64_t unscaled_frames = 0;              ///< whose errors are those of the fit alone
    std::int64_t worst_frame = 0;                  ///< with the largest share of doubtful spheres
    double worst_share = 0;                        ///< that share [-]
    MirrorOptics optics;                           ///< of the last frame
    OpticsErrors optics_error;

    /// Mean over frames [contrast].
    double mean_before() const { return per_frame(residual_before); }
    double mean_after() const { return per_frame(residual_rms); }
    double per_frame(double sum) const {
        return frames > 0 ? sum / static_cast<double>(frames) : 0;
    }
};

/// Synthesis (synthesise) of the frames of a film, one after the other.
///
/// The first frame starts at the middle of the cell and estimates the optics; those after it keep
/// them. A disc within 0.3 a of a sphere of the frame before starts at that one's height, all
/// others at the middle. A frame depends on the one before it, and not on the number of threads.
class FilmSynthesis {
 public:
    /// `diameter`: true diameter a [px]. `camera_distance` [a]: 0 is telecentric. `model` must
    /// outlive this. Throws OptionError for spheres brighter than their background.
    FilmSynthesis(const ImageModel& model, double diameter, double camera_distance,
                  const SynthesisOptions& options);

    /// `discs`: centres of all discs of the frame, those cut by the border included [px].
    /// `earlier`: of the frame before; null: there is none; without spheres, but with a residual:
    /// its optics alone are taken. Without discs nothing is found.
    SynthesisedFrame next(const Image& counts, const std::vector<Vec2>& discs,
                          const SynthesisedFrame* earlier, int threads) const;

    /// Fills position, errors, z, layer and quality of a snapshot in pixels, for the spheres that
    /// lie `border` [px] or more within its image. z is the height of the centre above the low
    /// plate, a/2 for a sphere that rests on it. The layer is the side of the middle of the cell,
    /// unknown within one standard error of it, and where the height is unknown.
    void report(const SynthesisedFrame& found, double border, Snapshot& snapshot) const;

    /// What a frame leaves to others.
    FilmOptics optics_of(const SynthesisedFrame& found) const;
    /// A frame without spheres, as next() takes it for the one before, that leaves these.
    static SynthesisedFrame leaving(const FilmOptics& film);
    /// Why optics of another film do not hold here; empty: they do.
    std::string mismatch(const FilmOptics& kept) const;

    /// Distance of the plates [px].
    double cell_height() const { return options_.height * diameter_; }

 private:
    const ImageModel& model_;
    double diameter_;
    double camera_distance_;
    SynthesisOptions options_;
};

void add(const SynthesisedFrame& found, std::int64_t frame, SynthesisSummary& summary);

/// Optics with their standard errors, on one line.
std::string in_words(const MirrorOptics& optics, const OpticsErrors& error);

/// Warns (WarningCode::doubtful_heights) of frames with more than 1 % of their spheres doubtful,
/// of those whose residual did not fall, and of those that leave more than kMostUnexplained; of
/// more unknown heights than known ones; of errors that are those of the fit alone
/// (WarningCode::unscaled_errors).
void warn_of(const SynthesisSummary& summary, RunPlan& plan);

/// Save or restore.
void transfer(NumberArchive& archive, MirrorOptics& optics);
void transfer(NumberArchive& archive, OpticsErrors& error);
void transfer(NumberArchive& archive, FilmOptics& film);
void transfer(NumberArchive& archive, SynthesisedFrame& found);
void transfer(NumberArchive& archive, SynthesisSummary& summary);

}  // namespace grainfield::tracking
