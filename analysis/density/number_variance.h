#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/density/count_grid.h"
#include "analysis/pattern.h"
#include "analysis/statistics/blocks.h"
#include "core/option_table.h"
#include "core/support/checkpoint.h"

namespace grainfield::analysis {

/// What the variance is taken over.
enum class VarianceReading {
    temporal,     ///< over frames at each position, then averaged over positions
    pooled,       ///< over frames and positions together
    spatial_mean  ///< over frames of the mean over positions
};

struct NumberVarianceOptions {
    double smallest = 1;   ///< smallest window [a]
    double largest = 80;   ///< largest window [a]
    double increment = 1;  ///< from window to window [a]
    double step = 0.25;    ///< displacement of the windows [a]
    VarianceReading reading = VarianceReading::temporal;
    std::optional<double> border{};  ///< strip left free along walls [a]; auto: 10, at most L/10
};

OptionTable describe(NumberVarianceOptions& options);

/// The observable "variance": variance of the number of particles in square windows of side ℓ that
/// slide over the box in steps of `step` (`castillo2019`). N_tp is the content of the window at
/// position p in frame t:
///
///   temporal  σ²(ℓ) = ⟨ Σ_t (N_tp − ⟨N_tp⟩_t)² / (T − 1) ⟩_p     static structure drops out
///   pooled    σ²(ℓ) = ⟨N_tp²⟩_tp − ⟨N_tp⟩_tp²                   (curve `variance_pooled`)
///   of the spatial mean  σ²(ℓ) = Σ_t (⟨N_tp⟩_p − ⟨N_tp⟩_tp)² / (T − 1)   (`variance_spatial_mean`)
///
/// Curve `variance` is the one that `reading` asks for, by default the temporal one; the pooled one
/// with a stated reason for a single frame. The last averages the fluctuations of windows away and
/// is there because the text can be read so. Curve `variance_slope`: β(ℓ) = d ln σ²/d ln ℓ of
/// `variance`, by a line through the sizes within 1.3 ℓ, at least one on each side. Windows have
/// corners on grid lines `step` apart and are counted exactly, in integers; the temporal average
/// needs only the mean content of the cells, because Σ_tp (N − ⟨N⟩_t)² = Σ_tp N² − Σ_p (Σ_t N)²/T.
/// On periodic axes all positions are used, wrapped, and ℓ is a multiple of L/round(L/step).
///
/// The factor T − 1 is that of independent frames. In a run that remembers its start the variance v
/// of ⟨N⟩_t is larger, and what is left too small. From 12 blocks of time on the temporal variance
/// and that of the spatial mean are Σ_t (N_tp − ⟨N_tp⟩_t)²/T + v, where that is more, v the
/// block_drift().variance_of_mean averaged over p. The pooled one is not corrected: between walls
/// it lacks the variance of the mean over t and p.
///
/// Error: from at most 16 blocks of time (left_out_error), and all that v adds to the variance of
/// independent frames. None of two or three frames, nor of a window whose block means drift
/// (least_step_ratio): its content changes too slowly for a run of this length, and σ² is too
/// small. For one frame: σ² sqrt(2/(n − 1)) with n = (region/ℓ)² windows side by side, taken as
/// independent.
///
/// Cost O(N + positions × sizes) a frame, and the positions × sizes of 48 frames at the end.
/// Memory: 4 B × cells × 16 blocks.
class NumberVariance {
 public:
    struct Sample {
        std::int64_t frame = 0;
        double particles = 0;
        std::vector<std::int32_t> cells;  // one a particle inside the border
        std::vector<WindowSums> sums;     // per size
    };

    /// Of a part of a run `frames` is the length of the run, `first` the number of its first frame.
    NumberVariance(const NumberVarianceOptions& options, const Box& box, std::int64_t frames,
                   int threads = 1, std::int64_t first = 0);

    /// Thread-safe. Throws InputError if the pattern's box is another one.
    Sample measure(const Pattern& pattern) const;
    void add(Sample sample);
    void merge(const NumberVariance& later);
    ObservableResult result() const;

    /// The sums gathered so far, under names that begin with `prefix`; `restore` takes them into an
    /// accumulator built with the same options. Throws InputError if they do not fit.
    void save(Checkpoint& checkpoint, const std::string& prefix) const;
    void restore(const Checkpoint& checkpoint, const std::string& prefix);

 private:
    struct Block {
        std::int64_t frames = 0;
        double particles = 0;
        std::vector<std::int32_t> contents;
        std::vector<WindowSums> sums;
        std::vector<Wide> squared_sums;  // Σ_t (Σ_p N)²
    };
    struct Values {
        std::vector<double> temporal, pooled, spatial_mean, mean;  // per size

        const std::vector<double>& of(VarianceReading reading) const;
    };
    struct Estimate {
        std::vector<double> variance, error;  // per size
        std::vector<std::string> reason;      // why there is no error
    };
    std::vector<double> frames_of(const std::vector<std::size_t>& blocks) const;
    std::vector<BlockDrift> drifts_of_positions() const;
    std::vector<BlockDrift> drifts_of_spatial_mean() const;
    Estimate estimate(const Values& best, const std::vector<Values>& left,
                      const std::vector<BlockDrift>& drifts, VarianceReading reading) const;
    bool is_in_slope(std::size_t s, std::size_t at) const;
    std::vector<double> slopes(const std::vector<double>& variance) const;
    void add_slopes(ObservableResult& result, const Values& best, const std::vector<Values>& left,
                    const Estimate& wanted, VarianceReading reading) const;
    void add_key_numbers(ObservableResult& result, const Values& best, const Estimate& wanted,
                         VarianceReading reading, const std::string& reason) const;
    Block empty_block() const;
    static void add_block(Block& to, const Block& from);
    std::vector<std::size_t> filled_blocks() const;
    Block total(std::optional<std::size_t> without) const;
    Values values(const Block& sums) const;
    double single_frame_error(double variance, double length) const;
    Curve curve(const char* name, const char* title, const std::vector<double>& variance,
                const std::vector<double>& error, const std::vector<double>& mean) const;

    NumberVarianceOptions options_;
    Box box_;
    CountGrid grid_;
    BlockPlan plan_;
    int threads_;
    std::vector<int> sizes_;       // in cells
    std::vector<double> lengths_;  // [a]
    std::int64_t first_;           // of the run
    std::int64_t added_ = 0;
    std::vector<Block> blocks_;
    MeanSeries density_;
};

}  // namespace grainfield::analysis
