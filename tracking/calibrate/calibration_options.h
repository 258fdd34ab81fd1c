#pragma once

#include <optional>

#include "core/option_table.h"

namespace grainfield::tracking {

enum class PolarityChoice { automatic, dark, bright };
enum class EdgeChoice { automatic, product, blurred_union };
enum class ProfileChoice { automatic, tanh, learned };

struct CalibrationOptions {
    std::optional<double> diameter;    ///< apparent diameter D [px]; empty: estimated
    std::optional<double> edge_width;  ///< w [px]; empty: estimated
    PolarityChoice polarity = PolarityChoice::automatic;
    EdgeChoice meeting_edges = EdgeChoice::automatic;  ///< which kind leaves the smaller residual
    ProfileChoice profile = ProfileChoice::tanh;  ///< what is learned is right for one layer only
    double uniform_tolerance = 0.003;  ///< background counts as uniform below this variation [-]
};

OptionTable describe(CalibrationOptions& options);

}  // namespace grainfield::tracking
