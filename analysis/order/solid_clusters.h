#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "analysis/order/bond_order.h"
#include "analysis/order/phase.h"
#include "analysis/pattern.h"
#include "analysis/statistics/blocks.h"
#include "core/results.h"

namespace grainfield::analysis {

/// Clusters of solid particles: their sizes and lifetimes. Part of the observable "phase".
///
/// In each window T_o, the particles that the phase history calls solid are joined where they are
/// neighbours (bond_order) in the last frame of the window. Single particles count as clusters of
/// size one.
///
///   n(s)  mean number of clusters of size s a window, in bins of factor 2   (curve `clusters`)
///
/// with the error of a mean over windows that may be alike (series_error). Short windows
/// (WindowRule), and the steps to and from them, are left out.
///
/// A cluster of at least `least` particles survives in the next window as the cluster that holds
/// most of its particles, if these are at least half of it. Of several that claim the same one the
/// largest survives; the others have died. Lifetime, for deaths at a constant rate, from the share
/// p of deaths in all steps from window to window Δ,
///
///   τ = −Δ/ln(1 − p),   error  σ_p Δ/((1 − p) ln²(1 − p)),
///
/// which counts clusters that outlive the run with what was seen of them. σ_p is that of
/// independent deaths, sqrt(p (1 − p)/steps), or that which the deaths of each step show
/// (ratio_error: clusters that die together, times of many deaths), whichever is larger.
///
/// Without windows (phase of every frame alone): sizes in at most 64 frames, no lifetimes.
/// Memory: the first and the last window, and some 200 B a window.
class SolidClusters {
 public:
    static constexpr std::size_t least = 8;  ///< particles of a cluster that has a lifetime

    /// One closed window (or frame): which particles are solid, and the neighbours of each.
    struct Frame {
        std::vector<std::int64_t> id;
        std::vector<bool> solid;  // of each particle
        const BondOrderField* field = nullptr;
        double time = 0;
        double frames = 1;  // of the window
    };

    /// `follows`: whether frames are windows one after the other, so that lives can be followed.
    explicit SolidClusters(bool follows) : follows_(follows) {}

    void add(const Frame& frame);

    /// Adds the windows that follow these; the run must have been cut between two windows.
    void merge(const SolidClusters& later);

    /// Appends curve and measurements to the result of "phase", of the windows that count.
    void add_to(ObservableResult& result, const WindowRule& rule = {}) const;

 private:
    struct Window {                                     // the solid particles, each in its cluster
        std::unordered_map<std::int64_t, int> cluster;  // of each identity
        std::vector<double> size;                       // of each cluster
        double time = 0;
        std::size_t number = 0;  // in the order of frames_
    };
    struct Step {  // from window to window
        std::size_t from = 0, to = 0;
        double trials = 0, deaths = 0;
        double time = 0;
    };
    void follow(const Window& before, const Window& now);
    void add_sizes(const std::vector<double>& size);
    std::vector<bool> counted(const WindowRule& rule) const;
    Measurement lifetime(const std::vector<bool>& counted) const;

    bool follows_;
    std::vector<MeanSeries> sizes_;   // clusters a window, by bin of factor two
    MeanSeries largest_, mean_size_;  // a window; NaN: no solid particle
    std::vector<double> frames_;      // in each window
    std::optional<Window> first_, last_;
    std::vector<Step> steps_;
};

}  // namespace grainfield::analysis
