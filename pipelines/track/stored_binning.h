#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/results.h"

namespace grainfield::pipelines {

/// By which blocks of pixels frames were fitted.
struct FittedBlocks {
    int side = 1;  ///< [px]
    std::string reason;

    bool operator==(const FittedBlocks&) const = default;
};

/// As the file of a trajectory holds it: one row.
Curve curve_of(const FittedBlocks& blocks);

/// The same from the curves of a trajectory; empty if they do not say, as those of versions up to
/// 2026-11-26, or if what is there is none.
std::optional<FittedBlocks> stored_binning(const std::vector<Curve>& curves);

}  // namespace grainfield::pipelines
