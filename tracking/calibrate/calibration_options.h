#pragma once

#include <optional>

#include "core/option_table.h"
#include "tracking/model/overlap_rule.h"
#include "tracking/model/tanh_edge.h"

namespace grainfield::tracking {

enum class PolarityChoice { automatic, dark, bright };
/// Whether what a profile lacks is learned where spheres stand alone; automatic: where it helps.
enum class Learning { never, automatic, always };

/// Darkness across a sphere.
struct ProfileChoice {
    const ProfileShape* shape = &kTanhEdge;
    Learning learning = Learning::never;  ///< what is learned is right for one layer only
    bool operator==(const ProfileChoice&) const = default;
};

/// By which blocks of pixels a frame is fitted.
struct BinningUse {
    int factor = 1;  ///< pixels a side; 1: pixels as they are
    /// None where noise is more than half of what discs leave, or edges are wider than this [px].
    /// Empty: in any case.
    std::optional<double> widest_edge = {};
    bool operator==(const BinningUse&) const = default;
};

struct CalibrationOptions {
    std::optional<double> diameter;    ///< apparent diameter D [px]; empty: estimated
    std::optional<double> edge_width;  ///< w [px]; empty: estimated
    PolarityChoice polarity = PolarityChoice::automatic;
    /// How discs that overlap make one image; null: the listed rule (known_models.h) that leaves
    /// the smallest residual.
    const OverlapRule* meeting_edges = nullptr;
    ProfileChoice profile;
    BinningUse binning;                ///< no option of its own: the film decides (model_of_film)
    double uniform_tolerance = 0.003;  ///< background counts as uniform below this variation [-]

    bool operator==(const CalibrationOptions&) const = default;
};

OptionTable describe(CalibrationOptions& options);

}  // namespace grainfield::tracking
