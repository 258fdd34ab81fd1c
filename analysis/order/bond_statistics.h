#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "analysis/order/bond_order.h"
#include "analysis/statistics/blocks.h"

namespace grainfield::analysis {

/// The observable "q4": distribution of |Q_k|, its mean and modes, mean distances to neighbours,
/// and the lattice spacing of the ordered particles.
///
///   ⟨|Q_k|⟩ over particles, then over frames; histogram in bins of 0.02;
///   lattice spacing: median of the mean distance of the four nearest over the particles inside a
///   crystal (|Q_k| ≥ `solid_above`, 0.7, theirs and that of all their neighbours), then mean over
///   frames. Without the condition on the neighbours, liquid particles that look ordered by chance
///   would raise it.
///
/// Measurements are called after the symmetry: q4_mean, q6_mean.
///
/// Errors of frame averages from blocks of frames; for a single frame particles are taken as
/// independent, which is said in `reason`. The modes of the histogram use the number of independent
/// frames that its fluctuations show: with H_j counts in bin j and frame, h_j their mean and
/// p_j = h_j/Σh, independent frames of independent particles have variance h_j (1 − p_j). The
/// variance found from frame to frame, v, falls short of it by the share 1 − v that never changes,
/// and V, that of the sums over blocks of m frames over m, exceeds v where frames in a row are
/// alike:
///
///   independent frames = 1/(1 − v + V/T),  at least 1, at most T; 1 below four frames,
///
/// and so does the error of the histogram, sqrt(p_j (1 − p_j)/n) for n independent particles.
///
/// Memory: 32 B a frame, 64 histograms, and the field of the last frame.
class BondStatistics {
 public:
    struct Sample {
        std::int64_t frame = 0;
        std::vector<std::int64_t> id;
        std::shared_ptr<const BondOrderField> field = std::make_shared<BondOrderField>();
    };

    /// `solid_above`: least |Q_k| of an ordered particle.
    explicit BondStatistics(const BondOrderOptions& options, double solid_above = solid_order);

    static Sample measure(const Pattern& pattern, const BondOrderOptions& options);
    void add(Sample sample);
    void merge(const BondStatistics& later);
    ObservableResult result() const;

 private:
    struct Block {  // counts of consecutive frames
        double frames = 0;
        std::vector<double> counts;
    };
    void add_measurements(ObservableResult& result) const;
    void add_modes(ObservableResult& result) const;
    double independent_frames() const;
    static std::vector<Block> joined_in_pairs(const std::vector<Block>& blocks);
    void halve_blocks();
    Curve histogram_curve() const;
    Curve field_curve() const;

    BondOrderOptions options_;
    double solid_above_;
    std::vector<double> histogram_;
    std::vector<double> squares_;  // Σ over frames of the squared counts of a bin
    std::vector<Block> blocks_;
    double block_length_ = 1;  // [frames]
    MeanSeries mean_, nearest_, spacing_;
    double single_spread_ = 0;  // standard error of the mean inside the last frame
    double single_nearest_ = 0;
    double single_spacing_ = 0;
    std::int64_t frames_ = 0;
    double defined_ = 0;  // particles with a defined Q, of all frames
    double single_count_ = 0;
    double single_inside_ = 0;  // particles inside a crystal in the last frame
    Sample last_;
};

}  // namespace grainfield::analysis
