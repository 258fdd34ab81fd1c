#pragma once

#include <utility>

#include "tracking/model/disc_profile.h"
#include "tracking/model/overlap_rule.h"
#include "tracking/model/radial_correction.h"

namespace grainfield::tracking {

/// How discs make a darkness image, in units of the contrast: one profile for all of them, a rule
/// for where they overlap, and what was learned of the profile. A plain product of tanh discs where
/// nothing else is said.
struct DiscModel {
    DiscProfile disc;
    const OverlapRule* overlap = &kProductRule;
    RadialCorrection correction;  ///< zero if none was learned

    DiscModel() = default;
    DiscModel(const DiscProfile& profile, const OverlapRule& rule = kProductRule,
              RadialCorrection learned = {})
        : disc(profile), overlap(&rule), correction(std::move(learned)) {}

    /// The product of transmissions is the whole model.
    bool is_product() const { return overlap->is_product() && correction.is_zero(); }
};

}  // namespace grainfield::tracking
