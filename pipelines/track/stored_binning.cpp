#include "pipelines/track/stored_binning.h"

#include <algorithm>
#include <cmath>

namespace grainfield::pipelines {

namespace {

constexpr const char* kName = "binning";
constexpr const char* kSide = "side";
constexpr double kLargestBlock = 32;  // track.binning

}  // namespace

Curve binning_curve(int side) {
    return {kName,
            "Blocks of pixels that frames were fitted by",
            {{kSide, "px", "Side", {static_cast<double>(side)}}},
            {}};
}

std::optional<int> stored_binning(const std::vector<Curve>& curves) {
    const auto found = std::ranges::find(curves, kName, &Curve::name);
    if (found == curves.end()) return std::nullopt;
    const Column* side = found->find(kSide);
    if (side == nullptr || side->values.size() != 1) return std::nullopt;
    const double value = side->values.front();
    if (!(value >= 1 && value <= kLargestBlock)) return std::nullopt;
    return static_cast<int>(std::lround(value));
}

}  // namespace grainfield::pipelines
