#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <vector>

#include "analysis/order/bond_order.h"
#include "analysis/pattern.h"
#include "analysis/statistics/blocks.h"
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
/// mean differences of the time stamps.
///
/// Measurements: order_length and order_time, where C falls below 1/e for the first time (by
/// ln C linear in between). No length, and a reason, where that is less than a diameter.
///
/// Errors in space: from the chosen frames in 16 blocks of time (left_out_error). In time: starting
/// frames follow each other within a correlation time and neighbours turn together, so that neither
/// are independent. Each of 16 starting frames is cut into 4 × 4 parts of the box, and with the
/// jackknife variances V over starting frames, over parts of the box (all times of each), and over
/// all 256 pieces,
///
///   error² = max(V_starts + V_parts − V_pieces, V_starts, V_parts) · (K − 1)/(K − 3),
///
/// which is right where pieces that differ in both are independent: for correlation lengths below
/// a quarter of the box or correlation times below a sixteenth of the run. Samples: as many
/// independent pieces would have this error.
///
/// Parts of one run: built with the number of frames of the whole and the number of their first
/// frame, merged in order, they give the result of the whole.
///
/// Cost about 30 ms for each of the 32 frames. Memory: 32 B a particle and starting frame; in a
/// part that is not the first also for each of the frames (30 at most of halves) that is a lag
/// after a starting frame before it.
class OrderCorrelation {
 public:
    struct Sample {
        double squares = 0;              ///< Σ |Q|²
        double particles = 0;            ///< with a Q
        std::vector<double> sum, pairs;  ///< by bin; empty: not one of the chosen frames
    };

    /// `frames`: of the whole run, of which this takes those from number `first` on.
    OrderCorrelation(const Box& box, std::int64_t frames, std::int64_t first = 0);

    /// Of the frame that will be added as number `ordinal` of the run. Thread-safe.
    Sample measure(const Pattern& pattern, const BondOrderField& field, std::int64_t ordinal) const;
    void add(const Sample& sample, const Pattern& pattern, const BondOrderField& field);

    /// Adds the part of the run that begins where this one ends. Throws InputError if it does not.
    void merge(const OrderCorrelation& later);

    /// Appends curves and measurements to the result of "q4".
    void add_to(ObservableResult& result) const;

 private:
    using Order = std::complex<double>;
    static constexpr std::size_t parts = 16;  // of the box
    struct Known {
        std::int64_t id = 0;
        Order q;
        std::uint8_t part = 0;
    };
    struct Seen {
        std::int64_t ordinal = 0;
        double time = 0;
        std::vector<Known> order;  // by growing id
    };
    struct LagSum {
        std::array<double, parts> product{}, squares{};
        double time = 0, frames = 0, particles = 0;
    };
    struct Block {
        double squares = 0, particles = 0;
        std::vector<double> sum, pairs;
    };
    static std::vector<Known> known(const Pattern& pattern, const BondOrderField& field);
    bool is_start(std::int64_t ordinal) const;
    bool is_lag_after(std::int64_t start, std::int64_t ordinal) const;
    void correlate(const Seen& start, const Seen& now);
    std::vector<double> correlation_in_time(std::size_t without_start, std::size_t without_part,
                                            bool both) const;
    void add_space(ObservableResult& result) const;
    void add_time(ObservableResult& result) const;

    std::int64_t frames_;
    std::int64_t first_;
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
    std::vector<Seen> starts_;
    std::vector<Seen> awaited_;                  // by starts before the first frame
    std::vector<std::vector<LagSum>> of_start_;  // [start][lag]
};

}  // namespace grainfield::analysis
