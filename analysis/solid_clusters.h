#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "analysis/blocks.h"
#include "analysis/bond_order.h"
#include "analysis/pattern.h"
#include "analysis/phase.h"
#include "core/results.h"

namespace grainfield::analysis {

/// Clusters of solid particles: their sizes and how long they live. Part of the observable "phase".
///
/// In each window T_o, the particles that the phase history calls solid are joined where they are
/// neighbours (bond_order) in the last frame of the window. Single particles count as clusters of
/// size one.
///
///   n(s)  mean number of clusters of size s a window, in bins of factor 2   (curve `clusters`)
///
/// A cluster of at least `least` particles lives on in the next window as the cluster that holds
/// most of its particles, if these are at least half of it, and of several that claim the same one
/// the largest lives on; else it has died. Lifetime, for deaths at a constant rate, with clusters
/// that outlive the run counted up to its end (`censored` maximum likelihood):
///
///   τ = (windows in which clusters were seen to live or die) · T_o / deaths,   error
///   τ/sqrt(deaths)
///
/// Without windows (phase of every frame alone): sizes in at most 64 frames, no lifetimes.
/// Memory: the last window.
class SolidClusters {
 public:
    static constexpr std::size_t least = 8;  ///< particles of a cluster that has a lifetime

    /// One closed window (or frame): who is solid and who neighbours whom.
    struct Frame {
        std::vector<std::int64_t> id;
        std::vector<bool> solid;  // of each particle
        const BondOrderField* field = nullptr;
        double time = 0;
    };

    /// `follows`: whether frames are windows one after the other, so that lives can be followed.
    explicit SolidClusters(bool follows) : follows_(follows) {}

    void add(const Frame& frame);

    /// Appends curve and measurements to the result of "phase".
    void add_to(ObservableResult& result) const;

 private:
    bool follows_;
    double windows_ = 0;
    std::vector<double> sizes_;  // clusters by bin of factor two
    MeanSeries largest_, mean_size_;
    std::unordered_map<std::int64_t, int> cluster_of_;  // of the last window: id → cluster
    std::vector<double> last_size_;
    double last_time_ = 0;
    double at_risk_ = 0;  // time
    double trials_ = 0;   // steps from window to window
    double deaths_ = 0;
};

}  // namespace grainfield::analysis
