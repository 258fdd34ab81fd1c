#include "pipelines/track/stored_binning.h"

#include <algorithm>
#include <cmath>

namespace grainfield::pipelines {

namespace {

constexpr const char* kName = "binning";
constexpr const char* kSide = "side";
constexpr const char* kReason = "reason";
constexpr double kLargestBlock = 32;  // track.binning

}  // namespace

Curve curve_of(const FittedBlocks& blocks) {
    return {kName,
            "Blocks of pixels that frames were fitted by",
            {{kSide, "px", "Side", {static_cast<double>(blocks.side)}}},
            {{kReason, {blocks.reason}}}};
}

std::optional<FittedBlocks> stored_binning(const std::vector<Curve>& curves) {
    const auto found = std::ranges::find(curves, kName, &Curve::name);
    if (found == curves.end()) return std::nullopt;
    const Column* side = found->find(kSide);
    const auto reason = found->text_columns.find(kReason);
    if (side == nullptr || side->values.size() != 1 || reason == found->text_columns.end() ||
        reason->second.size() != 1) {
        return std::nullopt;
    }
    const double value = side->values.front();
    if (!(value >= 1 && value <= kLargestBlock)) return std::nullopt;
    return FittedBlocks{static_cast<int>(std::lround(value)), reason->second.front()};
}

}  // namespace grainfield::pipelines
