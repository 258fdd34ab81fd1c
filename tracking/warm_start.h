#pragma once

#include <cstdint>
#include <vector>

#include "core/vec2.h"

namespace grainfield::tracking {

/// Frames are fitted in twos; the second starts from spheres two frames old.
inline constexpr std::int64_t kSideBySide = 2;
/// Above this RMS step a cold search is the cheaper one [D].
inline constexpr double kWarmStep = 0.25;

/// RMS distance of discs from the nearest of the frame before, the start of a warm search [px]. If
/// most have none within D/2, D. Identities play no part: they may be given later. O(discs).
double step_between(const std::vector<Vec2>& before, const std::vector<Vec2>& now, double diameter);

}  // namespace grainfield::tracking
