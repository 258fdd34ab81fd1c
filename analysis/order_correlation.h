#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <vector>

#include "analysis/blocks.h"
#include "analysis/bond_order.h"
#include "analysis/pattern.h"
#include "core/results.h"

namespace grainfield::analysis {

/// Correlation of the bond-orientational order in space and in time, curves of the observable
/// "q4":
///
///   C(r) = ⟨Re(Q_i* Q_j)⟩ over pairs r apart / ⟨|Q|²⟩                 (curve `q4_space`)
///   C(τ) = ⟨Re(Q_j*(t) Q_j(t + τ))⟩ over particles and t / ⟨|Q_j(t)|²⟩  (curve `q4_time`)
///
/// r up to 10 a (half the shorter side of the box, if that is less) in bins of 0.1 a, in 32 frames
/// spread over the run and from some 2,000 particles of each; τ from 16 starting frames spread
/// over the run, eight lags a decade up to half of it, for particles with identities. Lags are the
/// mean differences of the time stamps. Errors: jackknife over the chosen frames in 16 blocks, and
/// over the starting frames.
///
/// Measurements: order_length and order_time, where C falls below 1/e for the first time.
///
/// Cost about 30 ms for each of the 32 frames. Memory: 24 B a particle and starting frame.
class OrderCorrelation {
 public:
    struct Sample {
        double squares = 0;              ///< Σ |Q|²
        double particles = 0;            ///< with a Q
        std::vector<double> sum, pairs;  ///< by bin; empty: not one of the chosen frames
    };

    OrderCorrelation(const Box& box, std::int64_t frames);

    /// Of the frame that will be added as number `ordinal`. Thread-safe.
    Sample measure(const Pattern& pattern, const BondOrderField& field, std::int64_t ordinal) const;
    void add(const Sample& sample, const Pattern& pattern, const BondOrderField& field);

    /// Appends curves and measurements to the result of "q4".
    void add_to(ObservableResult& result) const;

 private:
    using Order = std::complex<double>;
    struct Known {
        std::int64_t id = 0;
        Order q;
    };
    struct Start {
        std::int64_t ordinal = 0;
        double time = 0;
        std::vector<Known> order;  // by growing id
    };
    struct LagSum {
        double product = 0, squares = 0, time = 0, frames = 0, particles = 0;
    };
    struct Block {
        double squares = 0, particles = 0;
        std::vector<double> sum, pairs;
    };
    static std::vector<Known> known(const Pattern& pattern, const BondOrderField& field);
    void add_space(ObservableResult& result) const;
    void add_time(ObservableResult& result) const;

    std::int64_t frames_;
    std::int64_t stride_;  // from one chosen frame to the next
    double reach_ = 0;
    std::size_t bins_ = 0;
    std::int64_t added_ = 0;
    bool linked_ = true;
    BlockPlan plan_;
    std::int64_t chosen_ = 0;
    std::vector<Block> blocks_;
    std::vector<std::int64_t> lags_;
    std::vector<std::int64_t> start_at_;
    std::vector<Start> starts_;
    std::vector<std::vector<LagSum>> of_start_;  // [start][lag]
};

}  // namespace grainfield::analysis
