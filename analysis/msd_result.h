#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/results.h"

namespace grainfield::analysis {

/// Sums of squared displacements by lag, group of particles and phase.
struct MsdTable {
    struct Series {
        std::vector<std::vector<double>> sum;    ///< [group][lag] [a^2]
        std::vector<std::vector<double>> pairs;  ///< [group][lag]
    };
    std::vector<double> time;      ///< of each lag [time unit]; NaN: no pair of frames
    std::array<Series, 3> series;  ///< all, liquid, solid
    /// Particles that have a pair of sightings, by phase: what the errors take as independent.
    std::array<double, 3> particles{};
    bool has_phases = false;
    std::string note;  ///< said with every number
};

/// Turns the sums into the curve `msd` (t, phase, msd, err, n) and the measurements `d_*`
/// (diffusion coefficient) and `exponent_*`, with jackknife errors over the groups.
///
/// Both are fitted over the last decade of lags: MSD = 4 D t + c with weights 1/t² (equal relative
/// errors), ln MSD = exponent · ln t + const. At least three lags are needed. `offset_*` is c:
/// 4 σ² of the localisation noise less 4 D t_e/3 of an exposure t_e. Curve `msd_fit`: the lines.
void add_msd(const MsdTable& table, ObservableResult& result);

}  // namespace grainfield::analysis
