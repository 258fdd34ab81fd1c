#pragma once

#include <string>

#include "core/results.h"

namespace grainfield::report {

/// What the MSD of a phase says of its diffusion.
struct DiffusionVerdict {
    bool is_diffusion = true;
    std::string words{};  ///< why there is none, or what the number still holds; empty: as it is
};

/// By the exponent of the MSD, less or more its standard error: all above 1.1 is flight. All below
/// 0.9 is a cage, but for an offset c that was not removed: c above a tenth of the MSD at the start
/// of the fitted decade, no localisation error given, and D known to half of itself. Then the MSD
/// is as steep in the later half of the decade as in the earlier one, and "offset not removed" is
/// said. Everything else is diffusion; so is a phase without an exponent. `phase`: "liquid".
DiffusionVerdict judge_diffusion(const ObservableResult& msd, const std::string& phase);

}  // namespace grainfield::report
