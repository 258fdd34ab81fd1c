#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "analysis/statistics/blocks.h"
#include "core/density_field.h"
#include "core/results.h"
#include "core/support/checkpoint.h"

namespace grainfield::analysis {

/// The observable "variance" of a field on a periodic lattice: variance of the content
/// N = Σ ρ dx^d of windows of m^d cells at all positions, about the mean, which is conserved,
///
///   σ²(ℓ) = ⟨(N − ρ̄ ℓ^d)²⟩,   ℓ = m dx = dx · 1, 2, 3, 4, 6, 8, 12, 16, … ≤ L/2 (shorter side).
///
/// Column `mean` of the curve is the volume ℓ^d, so that variance/mean tends to S(k → 0) for large
/// windows. Contents by running sums (`crow1984`); error: from at most 16 blocks of time
/// (left_out_error), none where these drift. Cost O(cells × sizes) a field, about 1 ns each.
/// Memory: 16 numbers a size.
class FieldVariance {
 public:
    /// `instants`: the blocks of time. Of each instant `replicas` fields are added, one after the
    /// other, all to one block.
    FieldVariance(const DensityField& field, int dimension, const BlockPlan& instants,
                  std::int64_t replicas = 1);

    /// ⟨(N − ρ̄ ℓ^d)²⟩ over the positions, per size. Thread-safe.
    std::vector<double> measure(const DensityField& field) const;
    void add(const std::vector<double>& sample);
    ObservableResult result() const;

    void save(Checkpoint& checkpoint, const std::string& prefix) const;
    void restore(const Checkpoint& checkpoint, const std::string& prefix);
    /// Goes on with the blocks of a run that became longer, a lengthened plan of its own.
    void lengthen(const BlockPlan& plan);

 private:
    double mean_square(const DensityField& field, int m, double mean) const;

    int dimension_;
    double spacing_;
    BlockPlan plan_;
    std::int64_t replicas_;
    std::vector<int> sizes_;  // in cells
    std::int64_t added_ = 0;
    std::vector<std::vector<double>> sums_;  // per block: frames, then per size
};

}  // namespace grainfield::analysis
