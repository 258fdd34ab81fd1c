#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/results.h"
#include "core/unit.h"

namespace grainfield::analysis {

/// How the frames of a run are cut into consecutive blocks of time for error estimates.
///
/// Frames inside a block may be correlated. Blocks are taken as independent, so the error of a mean
/// is right as soon as a block is longer than the correlation time.
struct BlockPlan {
    std::int64_t frames = 1;
    int blocks = 1;

    /// At most `most` blocks, at least one frame in each.
    static BlockPlan of(std::int64_t frames, int most = 16);

    /// The block of the ordinal-th frame; frames beyond the plan fall in the last one.
    int block_of(std::int64_t ordinal) const;
    /// The first frame of a block.
    std::int64_t first_of(int block) const;

    /// The plan of a run that was to have the frames of this one and is to have `longer`. Each of
    /// its blocks is made of whole blocks of this one, all of as many: the last blocks may stay
    /// empty, as in a run that was cut short. A run that is to be shorter keeps its plan.
    BlockPlan lengthened(std::int64_t longer) const;

    friend bool operator==(const BlockPlan&, const BlockPlan&) = default;
};

/// The blocks of `from`, each in the place that `to`, a lengthened `from`, has for it. `empty`: a
/// block without frames; add(to, from) joins two.
template <class Block, class Add>
std::vector<Block> lengthened_blocks(const std::vector<Block>& blocks, const BlockPlan& from,
                                     const BlockPlan& to, const Block& empty, Add add) {
    if (from == to) return blocks;
    std::vector<Block> placed(static_cast<std::size_t>(to.blocks), empty);
    for (int b = 0; b < from.blocks; ++b) {
        const auto place = static_cast<std::size_t>(to.block_of(from.first_of(b)));
        add(placed[place], blocks[static_cast<std::size_t>(b)]);
    }
    return placed;
}

/// Whether two runs are parts of one that were cut into blocks by its plan, the later one from
/// frame `first` on: their blocks are then added one by one.
inline bool are_cut_alike(const BlockPlan& plan, std::int64_t end, const BlockPlan& later,
                          std::int64_t first) {
    return later.frames == plan.frames && later.blocks == plan.blocks && first > 0 && first >= end;
}

/// Blocks of two runs one after the other, joined to those of BlockPlan::of their frames: each goes
/// whole to the block that it begins in, so that two halves give the blocks of the whole. A block
/// has a number `frames`; add(to, from) joins two.
template <class Block, class Add>
std::vector<Block> joined_blocks(std::vector<Block> blocks, Add add) {
    double frames = 0;
    for (const Block& block : blocks) frames += static_cast<double>(block.frames);
    const BlockPlan plan = BlockPlan::of(static_cast<std::int64_t>(frames));
    std::vector<Block> joined;
    int last = -1;
    double begin = 0;
    for (Block& block : blocks) {
        if (!(block.frames > 0)) continue;
        const int at = plan.block_of(static_cast<std::int64_t>(begin));
        begin += static_cast<double>(block.frames);
        if (at == last) {
            add(joined.back(), block);
        } else {
            joined.push_back(std::move(block));
        }
        last = at;
    }
    return joined;
}

/// Standard error of an estimate by the delete-one-block jackknife:
///   error² = (K − 1)/K Σ_b (θ_(b) − mean θ)²,  θ_(b) the estimate without block b.
/// Empty when fewer than `least` finite values are given. (`efron1982`)
std::optional<double> jackknife_error(std::span<const double> leave_one_out, std::size_t least = 3);

/// What n independent normal values widen the standard error of their mean by, the spread of
/// Student's t: sqrt((n − 1)/(n − 3)), so that (mean − truth)/error has variance one. n > 3.
double student_widening(double n);

/// The standard error that a result shows: jackknife_error times student_widening of the number K
/// of finite values, so that (estimate − truth)/error has variance one for few blocks too.
/// Every value is of a block (or group) that holds data: empty ones would count in K. Empty when
/// fewer than `least` finite values are given, at least four.
std::optional<double> student_jackknife_error(std::span<const double> leave_one_out,
                                              std::size_t least = 4);

/// Why a measurement has no error where student_jackknife_error has none.
inline constexpr const char* too_few_blocks =
    "fewer than four blocks of frames: no error from fluctuations";

/// Why a measurement has no error where what fluctuates drifts.
inline constexpr const char* slower_than_the_run =
    "changes too slowly for a run of this length: no error";

/// The correlation r from value to value of a series that relaxes exponentially, from the excess
/// `excess` of the variance of the means of `block` values over that of independent ones,
///   excess = (1 + r)/(1 − r) − 2 r (1 − r^b)/(b (1 − r)²),  b = block,
/// which rises with r. 0 for an excess of one or less.
double correlation_of_excess(double excess, double block);

/// How the means m_b of K consecutive blocks of f_b frames, F in all, scatter about their mean m,
/// and from one to the next; for independent frames both are K − 1 times the variance of a block
/// mean, `steps` twice that.
struct BlockScatter {
    double squares = 0;  ///< K/F Σ_b f_b |m_b − m|²
    double steps = 0;    ///< K/F Σ_b 2 f_b f_(b+1)/(f_b + f_(b+1)) |m_(b+1) − m_b|²
};

/// Adds the scatter of real or complex means. `frames`: of each block, above zero.
template <class Value>
void add_scatter(BlockScatter& to, std::span<const double> frames, std::span<const Value> means) {
    if (means.empty()) return;
    // From the first one, so that equal means have no scatter.
    double all = 0;
    Value mean = 0;
    for (std::size_t b = 0; b < means.size(); ++b) {
        all += frames[b];
        mean += frames[b] * (means[b] - means[0]);
    }
    mean /= all;
    const double weight = static_cast<double>(means.size()) / all;
    for (std::size_t b = 0; b < means.size(); ++b) {
        to.squares += weight * frames[b] * std::norm(means[b] - means[0] - mean);
        if (b == 0) continue;
        const double both = 2 * frames[b] * frames[b - 1] / (frames[b] + frames[b - 1]);
        to.steps += weight * both * std::norm(means[b] - means[b - 1]);
    }
}

/// Below this step_ratio block means drift: what fluctuates changes too slowly for a run of this
/// length. Of 16 blocks, the run is then shorter than some 15 relaxation times by the formula
/// below.
inline constexpr double least_step_ratio = 0.5;

/// What the means of consecutive blocks say about the mean of a run.
struct BlockDrift {
    double step_ratio = 1;  ///< steps/(2 squares), 1 for independent blocks (`vonneumann1941`)
    double variance_of_mean = 0;  ///< of the run, in the square of the unit of its values
    double excess = 1;            ///< variance_of_mean over squares/(K (K − 1))
};

/// Of K blocks of a quantity that relaxes exponentially, x the length of a block over the time that
/// takes; the scatter may be a sum over quantities that are alike:
///   step_ratio = (1 − c)(K − 1)/(K (1 − g)),   g = V(K x)/V(x),   V(x) = 2 (x − 1 + e^−x)/x²,
///   variance_of_mean = excess squares/(K (K − 1)),   excess = (K − 1) g/(1 − g),
/// V the variance of the mean over a time x, c = (1 − e^−x)²/(x² V(x)) the correlation of one block
/// with the next. Below least_step_ratio x is that at this ratio: variance_of_mean is then no more
/// than a lower bound. Below 12 blocks the ratio is too noisy to correct with, and the excess one;
/// below 8, and without scatter, nothing is known: {1, 0, 1}.
BlockDrift block_drift(const BlockScatter& scatter, std::size_t blocks);

/// The number M' in the factor M'/(M' − 1) of a variance s² about the mean of a run, from the
/// number of independent frames M = K s²/(squares/(K − 1)): M' = 1 + M/excess.
double frames_of_mean(double independent, const BlockDrift& drift);

/// Standard error of the mean of a series of values that may be correlated, and how many
/// independent ones it is worth.
struct SeriesError {
    std::optional<double> error;
    double samples = 0;    ///< between 1 and the number of values
    std::string reason;    ///< why there is no error
    bool is_slow = false;  ///< changes more slowly than the series is long
};

/// From 64 values T on: with s² the variance of the values and v that of the means of K = 16 blocks
/// of b = T/K consecutive values, the excess b v/s² gives the correlation r of values that relax
/// exponentially (correlation_of_excess), and
///   samples = T (1 − r)/(1 + r),   error² = s²/samples · (K − 1)/(K − 3);
/// values that are correlated negatively (an excess below one) have the plain block error. From 8
/// values on r is the correlation of neighbours (corrected for the mean, taken from 1/sqrt(T) up).
/// From 4 to 7 values they are taken as independent.
///
/// No error, and a reason: fewer than four values; all the same (up to rounding of `scale`);
/// correlated over so large a part of the series that fewer than three independent values are left,
/// or that half the mean square step of the block means is below a third of their variance
/// (`vonneumann1941`; independent values fall below it once in some 500 series).
SeriesError series_error(std::span<const double> series, double scale = 0);

/// The same of an estimate, from those with one of K consecutive blocks left out: the series of
/// −(K − 1) times these, which have the variance of the values of the blocks. Empty if one of them
/// is not finite.
SeriesError left_out_error(std::span<const double> leave_one_out);

/// The same of the ratio Σa/Σb of two sums that each value adds to, in first order: of the series
/// of a − (Σa/Σb) b over those with b > 0.
SeriesError ratio_error(std::span<const double> a, std::span<const double> b);

/// Mean of a sequence of per-frame values with its error.
struct MeanSeries {
    std::vector<double> value;  ///< one per frame [8 B a frame]

    void add(double x) { value.push_back(x); }
    void append(const MeanSeries& later);

    /// The mean; error and samples from series_error. Below four frames `single_error` and
    /// `single_samples`, those of one frame, are used, with `single_reason` for one frame saying
    /// what they mean.
    Measurement measurement(std::string name, Unit unit, std::optional<double> single_error,
                            const std::string& single_reason, double single_samples = 1) const;
};

/// A measurement of so many samples; without an error `reason` says why there is none.
Measurement measured(std::string name, Unit unit, double value, std::optional<double> error,
                     double samples, std::string reason = "");

/// A measurement that has no value, and why.
Measurement missing(std::string name, Unit unit, std::string reason);

}  // namespace grainfield::analysis
