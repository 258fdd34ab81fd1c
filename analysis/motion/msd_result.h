#pragma once

#include <array>
#include <optional>
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
    std::string note;                      ///< said with every number
    std::optional<double> exposure{};      ///< t_e of a frame [time unit], if known
    std::optional<double> localisation{};  ///< σ per axis of a position [a], if known
};

/// Turns the sums into the curve `msd` (t, phase, msd, err, n) and the measurements `d_*`
/// (diffusion coefficient) and `exponent_*`, with jackknife errors over the groups that
/// have pairs, at least four, and Student's factor (student_jackknife_error).
///
/// Both are fitted over the last decade of lags: MSD = 4 D t + c with weights 1/t² (equal relative
/// errors), ln(MSD − 4 σ²) = exponent · ln t + const, where σ is 0 unless it is given. At least
/// three lags are needed. Curve `msd_fit`: the lines. `offset_*` is c, which a position with noise
/// σ per axis, averaged over an exposure t_e, makes (`savin2005`, `berglund2010`; for Brownian
/// motion and lags t ≥ t_e)
///
///   MSD(t) = 4 D (t − t_e/3) + 4 σ²,   c = 4 σ² − (4/3) D t_e.
///
/// c alone cannot tell σ from t_e. With t_e given, `localisation_*` = sqrt((c + 4 D t_e/3)/4) [a];
/// with σ given, `exposure_*` = 3 (4 σ² − c)/(4 D) [time unit]; with both c is held: D is the only
/// unknown, and far better known where the lags are short.
void add_msd(const MsdTable& table, ObservableResult& result);

}  // namespace grainfield::analysis
