#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/order/phase.h"
#include "analysis/pattern.h"
#include "analysis/track_index.h"
#include "core/option_table.h"

namespace grainfield::analysis {

enum class LagSpacing { logarithmic, all };

struct DisplacementOptions {
    LagSpacing lags = LagSpacing::logarithmic;
    int per_decade = 8;                    ///< lags a decade when logarithmic [-]
    std::int64_t longest = 0;              ///< longest lag [frames]; 0: half the duration
    double memory_mb = 1024;               ///< bound of the stored tracks [MB]
    std::vector<std::int64_t> van_hove{};  ///< lags of the van Hove function [frames]
    std::optional<double> exposure{};      ///< of a frame [time unit]
    std::optional<double> localisation{};  ///< error per axis of a position [a]
};

OptionTable describe(DisplacementOptions& options);

/// The observable "msd": mean squared displacement, of all particles and by phase,
///
///   MSD(τ) = ⟨|r_j(t + τ) − r_j(t)|²⟩ over particles j and start times t,
///
/// taken over every pair of frames τ apart in which particle j was seen (a gap in a track removes
/// its pairs, nothing is interpolated). The phase is that of the particle at the start, in the
/// window of the phase history that contains t; none in a short window (WindowRule). Lags are
/// differences of time stamps, not of frame numbers: pairs of frames share a lag if their
/// differences agree within a tenth; t in the curve is their mean. Stamps that fit no even grid
/// that well give a reason. Positions are unwrapped by minimum images (a particle must move less
/// than half a periodic box between two sightings) and stored relative to the track's first one, so
/// nothing is lost far from the origin.
///
/// Errors: jackknife over 16 groups of particles with Student's factor (particles as independent;
/// overlapping start times are thereby allowed for). D = slope/4 over the last decade of lags with
/// free offset, so that localisation noise (4σ²) and exposure do not enter; exponent = d ln(MSD −
/// 4σ²)/d ln τ there, σ = 0 unless given. What the offset says when exposure or noise are given:
/// add_msd.
///
/// On request the self part of the van Hove function, curve `van_hove`: the density of the
/// displacements Δx and Δy at given lags, of all particles (lags in numbers of frames, as
/// `longest`: of every fourth frame the shortest lag is 4),
///
///   G_s(x, τ) = ⟨δ(x − Δx_j(τ))⟩,   bins of a fifth of the root mean square up to six of them,
///
/// and of each lag the non-Gaussian parameter α2 = ⟨Δx⁴⟩/(3 ⟨Δx²⟩²) − 1 (zero for Brownian
/// motion), both with the error by groups.
///
/// Cost O(observations × lags). Memory 16 B an observation, 120 B a track; when it would pass
/// `memory_mb` half of the particles, chosen by a hash of their identity, are left out (and said).
class Displacement {
 public:
    using Sample = Pattern;

    Displacement(const DisplacementOptions& options, std::int64_t frames, int threads = 1);

    void add(const Pattern& pattern);
    void merge(const Displacement& later);
    ObservableResult result() const { return result(nullptr); }

    /// With phases, if there is a history of them (its last window closed).
    ObservableResult result(const PhaseHistory* phases) const;

 private:
    static constexpr std::size_t groups = 16;
    static constexpr std::size_t classes = 3;  // all, liquid, solid

    struct Track {
        std::int64_t id = 0;
        std::size_t first = 0;   // ordinal of the first frame
        Vec2 last;               // as read
        Vec2 moved;              // unwrapped displacement since the first sighting
        Vec2 origin;             // first sighting
        std::vector<Vec2> step;  // unwrapped displacement per ordinal; NaN: not seen
    };
    struct Clock {  // the frames on an even grid of time
        double step = 1;
        int parts = 1;                     // steps in the median interval
        double per_frame = 1;              // steps from a frame number to the next
        std::vector<std::size_t> slot;     // of each ordinal
        std::vector<std::int64_t> window;  // of the phases, of each ordinal; -1: none
        std::size_t slots = 0;
    };
    struct LagSums {
        std::array<double, classes> sum{};
        std::array<double, classes> pairs{};
    };
    struct Sums {
        std::vector<LagSums> lags;
        std::array<double, classes> particles{};  // that have a pair
    };
    void place(Track& track, std::size_t ordinal, Vec2 step);
    void thin_out();
    void drop_left_out();
    std::optional<Clock> clock() const;
    std::vector<std::size_t> lags(const Clock& clock) const;
    std::vector<double> lag_times(const Clock& clock, const std::vector<std::size_t>& lags) const;
    void add_van_hove(const Clock& clock, ObservableResult& result) const;
    void add_track(const Track& track, const Clock& clock, const std::vector<std::size_t>& lags,
                   const PhaseHistory* phases, Sums& sums) const;

    DisplacementOptions options_;
    std::int64_t expected_frames_;
    int threads_;
    std::vector<std::int64_t> frame_;
    std::vector<double> time_;
    TrackIndex index_;
    std::vector<Track> tracks_;
    Box box_;
    std::size_t stored_ = 0;      // capacity of all steps
    std::uint64_t thinning_ = 0;  // identities with hash & thinning_ != 0 are left out
    bool linked_ = true;
};

}  // namespace grainfield::analysis
