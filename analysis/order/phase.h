#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/order/bond_order_options.h"
#include "analysis/statistics/blocks.h"
#include "analysis/track_index.h"
#include "core/option_table.h"
#include "core/trajectory.h"

namespace grainfield::analysis {

struct PhaseOptions {
    double liquid_below = 0.4;         ///< largest mean |Q4| of a liquid particle [-]
    double solid_above = solid_order;  ///< least mean |Q4| of a solid particle [-]
    std::optional<double> window{};    ///< averaging time T_o [time unit]; auto: see PhaseWindow
};

OptionTable describe(PhaseOptions& options);

enum class Phase : std::int8_t { unknown = -1, liquid = 0, between = 1, solid = 2 };

/// The averaging time T_o: 32 vibration periods if the vibration frequency is known, else 0.4 s if
/// times are in seconds, else none: every frame stands alone.
struct PhaseWindow {
    std::optional<double> length;  ///< [time unit]
    std::string reason;            ///< why there is none
    static PhaseWindow of(const PhaseOptions& options, const TrajectoryInfo& info);
};

/// Which windows T_o count. A window that holds fewer than half of the median number of frames is
/// short, as at the end of a run or of a part of it. The average of few frames scatters more, so
/// that more particles pass for solid. Fractions, their curve, clusters and displacements by phase
/// all leave it out.
struct WindowRule {
    double least = 0;  ///< frames
    bool is_short(double frames) const { return frames < least; }
};

/// The observable "phase": each particle is liquid, solid or between by its time average
///
///   m_j = ⟨|Q4^j|⟩ over T_o;  liquid: m_j ≤ 0.4, solid: m_j ≥ 0.7
///
/// (`castillo2019`). Windows of length T_o lie on a fixed grid of time, n T_o ≤ t < (n+1) T_o; a
/// particle is classified in a window in which it is seen in at least half of the frames. Without
/// identities, with one frame or without T_o every frame is its own window, and `reason` says so,
/// as it does when T_o is so short that no window holds two frames. Short windows (WindowRule) are
/// in neither the curve `phase` nor the means, and `reason` counts them.
///
/// Curve `q4_fluctuation`: mean over particles and windows of the standard deviation σ of |Q4| in
/// the window, by its mean m in bins of 0.05 (windows in which a particle is seen five times or
/// more): solid and liquid fluctuate less than what goes to and fro. Measurement `q4_fluctuation`:
/// the mean over all of them. Errors from the series of windows, which may be alike (ratio_error);
/// samples: as many independent particles would have this error.
///
/// Only windows that hold a frame exist, however long the time between frames and however short
/// T_o: there are never more of them than frames. Memory: 1 B a particle and window, 600 B a
/// window, 72 B an identity.
class PhaseHistory {
 public:
    struct Sample {
        std::int64_t frame = 0;
        double time = 0;
        std::vector<std::int64_t> id;
        std::vector<float> abs_q;  ///< NaN: undefined
    };

    PhaseHistory(const PhaseOptions& options, const TrajectoryInfo& info, std::int64_t frames);

    void add(Sample sample);
    void merge(const PhaseHistory& later);
    ObservableResult result() const;

    /// Classes can be asked for once the last window is closed; `add` may go on after that.
    void close_window();

    /// The class of each window that particle `id` was followed through, from window
    /// `first_window`; empty if unknown. Windows are numbered in the order in which they were
    /// first seen; -1: no such window.
    std::span<const Phase> classes(std::int64_t id, std::int64_t& first_window) const;
    std::int64_t window_of(double time) const;

    /// How many windows are closed.
    std::int64_t windows() const { return static_cast<std::int64_t>(windows_.size()); }

    /// Which of them count, by all frames so far.
    WindowRule rule() const;

    /// Frames of a window, as its classes were made from them; 0: no such window.
    double frames_in(std::int64_t window) const;

    /// Whether particles are followed through windows of more than one frame.
    bool follows() const { return window_.length.has_value(); }

 private:
    struct Track {
        double sum = 0;
        double squares = 0;
        int count = 0;
        std::int64_t first_window = 0;
        std::vector<Phase> classes;
    };
    struct Row {
        std::int64_t frame = 0;
        double time = 0;
        double frames = 1;
        double solid = 0;  // particles
        double liquid = 0;
        double all = 0;
    };
    Phase classify(double mean) const;
    void count(Row& row, Phase phase) const;
    double key_of(double time) const;
    static void note(Track& track, std::int64_t window, Phase phase);
    std::string remark(std::size_t windows, std::size_t left_out) const;
    void note_fluctuation(const Track& track);
    void add_fluctuation(ObservableResult& result) const;
    void add_alone(const Sample& sample);

    PhaseOptions options_;
    PhaseWindow window_;
    std::int64_t frames_ = 0;
    TrackIndex index_;
    std::vector<Track> tracks_;
    std::vector<std::size_t> touched_;
    double open_key_ = 0;
    Row open_;
    int open_frames_ = 0;
    std::map<double, std::int64_t> windows_;  // number of each window by its place on the grid
    std::vector<double> frames_in_;           // of each window by its number
    std::vector<Row> rows_;
    struct Spread {  // of the standard deviations in a bin of m
        double sum = 0, squares = 0, count = 0;
    };
    static constexpr std::size_t spread_bins = 20;
    using Spreads = std::array<Spread, spread_bins>;
    std::vector<Spreads> spreads_;  // of each window that has any
    Spreads open_spreads_{};
    struct Fluctuation {
        double mean = 0, count = 0;
        SeriesError found;
    };
    Fluctuation fluctuation(std::size_t first_bin, std::size_t last_bin) const;
};

}  // namespace grainfield::analysis
