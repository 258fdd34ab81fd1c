#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/vec2.h"

namespace grainfield::tracking {

/// What is known of the true particles of one frame; columns as long as `position`.
struct TruthFrame {
    std::vector<Vec2> position;  ///< [px]
    /// Bit c: belongs to class c. No bit: may be matched but counts nowhere (outside the frame).
    std::vector<std::uint64_t> classes;
    std::vector<Vec2> bound;  ///< Cramér–Rao bound per axis [px], NaN: none; empty: unknown
};

/// Scores of one class of particles over all frames; errors are found − true, per axis [px].
struct ClassScore {
    std::string name;
    std::int64_t matched = 0;   ///< TP
    std::int64_t missed = 0;    ///< FN
    std::int64_t spurious = 0;  ///< FP: found without partner, nearest true particle in this class

    double recall() const;     ///< TP/(TP + FN); NaN where there was nothing to find
    double precision() const;  ///< TP/(TP + FP); NaN where nothing was found
    double jaccard() const;    ///< TP/(TP + FN + FP); NaN where there was neither

    Vec2 bias() const;             ///< mean error [px]
    Vec2 rmse() const;             ///< per axis [px]
    double rmse_per_axis() const;  ///< sqrt of the mean over both axes; lateral: √2 larger

    /// RMS bound over the resolved particles [px]: those whose bound is below a third of the gate
    /// in both axes. Beyond that the gate, not the tracker, decides about the error.
    double bound() const;
    /// RMSE of the resolved particles over their RMS bound [-]: 1 is the best possible.
    double bound_ratio() const;
    /// RMS of error/reported standard error over the resolved particles, or all where no bound is
    /// known: 1 if the tracker's error bars are right.
    double pull_rms() const;
    /// Share of those errors that lie within two reported standard errors: 0.954 if the error bars
    /// are right and the errors Gaussian; NaN without any.
    double within_two_sigma() const;

    std::int64_t resolved = 0;
    std::int64_t pulls = 0;             ///< errors (two a particle) with a reported standard error
    std::int64_t pulls_within_two = 0;  ///< of those, within twice that
    Vec2 error_sum, square_sum;
    double resolved_squares = 0, bound_squares = 0, pull_squares = 0;
};

/// How the particles found in one frame belong to the true ones.
struct FrameMatch {
    std::vector<int> partner;  ///< of each true particle: index found, −1 if missed
    /// Of each particle found: the classes it counts in, those of its partner or, without one, of
    /// the true particle nearest to it; class 0 where there is none. 0: it counts nowhere.
    std::vector<std::uint64_t> classes;
};

/// Mean error against the sub-pixel phase of the true position, x − floor(x + 1/2) ∈ [−½, ½).
struct PhaseBin {
    double phase = 0;  ///< centre of the bin [px]
    double mean = 0;   ///< weighted mean error [px]; NaN where the bin is empty
    double error = 0;  ///< its standard error, from the scatter [px]
};

/// How well found positions meet the truth (Scores: `chenouard2014`; docs/validation.md).
///
/// Found and true positions are matched one-to-one, nearest first, within the gate
/// (match_positions). A found position that has no partner is spurious in the classes of the true
/// particle nearest to it. It counts in class 0 where a frame holds no true particle. Particles
/// without any class may be matched and count nowhere.
///
/// Memory O(classes). One thread; the caller adds frames in order.
class DetectionScores {
 public:
    static constexpr int kPhaseBins = 20;
    static constexpr int kPullBins = 48;
    static constexpr double kLargestPull = 6;  ///< of the histogram

    /// At most 64 classes; `gate` [px], 0.25 D for grains. Throws OptionError otherwise.
    DetectionScores(std::vector<std::string> classes, double gate);

    /// `errors`: reported standard errors per axis [px], one a found position or none. Returns the
    /// pairs (match_positions). Throws InputError if columns differ in length.
    FrameMatch add(const TruthFrame& truth, const std::vector<Vec2>& found,
                   const std::vector<Vec2>& errors);

    double gate() const { return gate_; }
    std::int64_t frames() const { return frames_; }
    const std::vector<ClassScore>& classes() const { return classes_; }
    /// Throws OptionError if there is no such class.
    const ClassScore& find(const std::string& name) const;

    /// Error of axis 0 (x) or 1 (y) against the phase along it, over class 0. Weights 1/bound²,
    /// over resolved particles; where no bounds are known all weights are 1.
    std::vector<PhaseBin> phase_curve(int axis) const;

    /// How much positions are drawn to (or from) the pixel grid: the first harmonic of the phase
    /// curve, mean + a cos 2πφ + b sin 2πφ, and all that is not constant.
    struct Locking {
        double amplitude = 0;  ///< sqrt(a² + b²) [px]; NaN if bins are empty
        double error = 0;      ///< standard error of a and b [px]: what chance alone gives
        double rms = 0;        ///< of the curve about its mean, less what chance gives [px]
    };
    Locking pixel_locking(int axis) const;

    /// Number of errors/reported standard errors in bins of [−6, 6), both axes, over the resolved
    /// particles of class 0; and of those outside.
    std::span<const std::int64_t> pull_histogram() const { return pull_histogram_; }
    std::int64_t pulls_beyond() const { return pulls_beyond_; }

 private:
    struct PhaseSums {
        std::int64_t count = 0;
        double weight = 0, error = 0;                               // Σ w, Σ w e
        double weight2 = 0, weight2_error = 0, weight2_error2 = 0;  // Σ w², Σ w² e, Σ w² e²
    };
    void add_match(ClassScore& score, Vec2 error, Vec2 bound, Vec2 reported) const;
    void add_phase(Vec2 truth, Vec2 error, Vec2 bound);
    void add_pulls(Vec2 error, Vec2 bound, Vec2 reported);
    bool is_resolved(Vec2 bound) const;

    double gate_;
    std::int64_t frames_ = 0;
    std::vector<ClassScore> classes_;
    std::array<std::array<PhaseSums, kPhaseBins>, 2> phase_{};
    std::array<std::int64_t, kPullBins> pull_histogram_{};
    std::int64_t pulls_beyond_ = 0;
};

}  // namespace grainfield::tracking
