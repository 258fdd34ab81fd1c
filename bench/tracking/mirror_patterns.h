#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/frame.h"
#include "core/support/random.h"
#include "core/vec3.h"
#include "tracking/synthesis/general_correction.h"
#include "tracking/track_options.h"

namespace grainfield::bench {

/// Every fourth camera is left out in turn.
inline constexpr std::size_t kFolds = 4;

/// What discs leave over in two frames of the same spheres by one camera. Empty: the frame cannot
/// be calibrated, holds fewer than 100 spheres, its discs have an unusual size, or they leave less
/// than half of the noise of a pixel. Blocks have less noise, so that `track` judges some frames
/// more.
struct CameraPatterns {
    std::string name;
    std::optional<tracking::ResidualPattern::Numbers> mirrors = {};
    std::optional<tracking::ResidualPattern::Numbers> rims = {};  ///< of discs with a rim
};

/// `frame`: of mirrors, whose centres are `spheres` [px]. `scale`: a [px]. `random`: of the camera
/// that sees discs with a rim in their places.
CameraPatterns patterns_of(const std::string& name, const Image& frame,
                           std::span<const Vec3> spheres, double scale,
                           const tracking::TrackOptions& options, RandomStream& random);

/// Throws InputError where too few of a kind are left to describe it once a fold is left out.
void require_enough(const std::vector<CameraPatterns>& cameras);

/// Both kinds, of all cameras but those of one fold; kFolds: of all.
void describe_patterns(const std::vector<CameraPatterns>& cameras, std::size_t without,
                       tracking::GeneralCorrection& general);

/// How well cameras left out are told apart.
void print_patterns(const std::vector<CameraPatterns>& cameras);

}  // namespace grainfield::bench
