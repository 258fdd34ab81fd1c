#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "analysis/accumulator.h"
#include "analysis/blocks.h"
#include "analysis/bond_order.h"

namespace grainfield::analysis {

/// The observable "q4": distribution of |Q_k|, its mean and modes, mean distances to neighbours,
/// and the lattice spacing of the ordered particles.
///
///   ⟨|Q_k|⟩ over particles, then over frames; histogram in bins of 0.02;
///   lattice spacing: median of the mean distance of the four nearest over the particles inside a
///   crystal (|Q_k| ≥ 0.7, theirs and that of all their neighbours), then mean over frames. Without
///   the condition on the neighbours, liquid particles that look ordered by chance would raise it.
///
/// Errors of frame averages from blocks of frames; for a single frame particles are taken as
/// independent, which is said in `reason`. Memory: 32 B a frame, and the field of the last frame.
class BondStatistics {
 public:
    struct Sample {
        std::int64_t frame = 0;
        std::vector<std::int64_t> id;
        BondOrderField field;
    };

    explicit BondStatistics(const BondOrderOptions& options);

    static Sample measure(const Pattern& pattern, const BondOrderOptions& options);
    void add(Sample sample);
    void merge(const BondStatistics& later);
    ObservableResult result() const;

 private:
    void add_measurements(ObservableResult& result) const;
    Curve histogram_curve() const;
    Curve field_curve() const;

    BondOrderOptions options_;
    std::vector<double> histogram_;
    MeanSeries mean_, nearest_, spacing_;
    double single_spread_ = 0;  // standard error of the mean inside the last frame
    double single_nearest_ = 0;
    double single_spacing_ = 0;
    std::int64_t frames_ = 0;
    double defined_ = 0;  // particles with a defined Q
    Sample last_;
};

static_assert(Accumulator<BondStatistics>);

/// The options of a table as they are recorded with a result.
std::vector<std::pair<std::string, OptionValue>> recorded(const OptionTable& table);

}  // namespace grainfield::analysis
