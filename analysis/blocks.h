#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/results.h"

namespace grainfield::analysis {

/// How the frames of a run are cut into consecutive blocks of time for error estimates.
///
/// Frames inside a block may be correlated; blocks are taken as independent, so that the error of
/// a mean is honest as soon as a block is longer than the correlation time.
struct BlockPlan {
    std::int64_t frames = 1;
    int blocks = 1;

    /// At most `most` blocks, at least one frame in each.
    static BlockPlan of(std::int64_t frames, int most = 16);

    /// The block of the ordinal-th frame; frames beyond the plan fall in the last one.
    int block_of(std::int64_t ordinal) const;
};

/// Standard error of an estimate by the delete-one-block jackknife:
///   error² = (K − 1)/K Σ_b (θ_(b) − mean θ)²,  θ_(b) the estimate without block b.
/// Empty when fewer than `least` finite values are given. (`efron1982`)
std::optional<double> jackknife_error(std::span<const double> leave_one_out, std::size_t least = 3);

/// Mean of a sequence of per-frame values with its block error.
struct MeanSeries {
    std::vector<double> value;  ///< one per frame [8 B a frame]

    void add(double x) { value.push_back(x); }
    void append(const MeanSeries& later);

    /// The mean; error from at most 16 blocks of consecutive frames; samples: the number of
    /// independent frames that explains it, var(frame)/error², between 1 and the number of frames
    /// (from 16 blocks it is known to about a third). Frames that are all the same have no error,
    /// and a reason. `single_error` and `single_samples` are used when there is one frame, with
    /// `single_reason` saying what they mean.
    Measurement measurement(std::string name, std::string unit, std::optional<double> single_error,
                            const std::string& single_reason, double single_samples = 1) const;
};

/// A measurement that has no value, and why.
Measurement missing(std::string name, std::string unit, std::string reason);

}  // namespace grainfield::analysis
