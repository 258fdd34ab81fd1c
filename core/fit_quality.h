#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace grainfield {

/// How well an image model explains a frame.
enum class FitQuality : std::uint8_t { good, fair, poor };

/// Judges the RMS residual of an image model by the noise of the camera, both in units of the
/// contrast. `noise` 0: not known, and taken as none.
///
/// Poor: above twice the noise, but never up to 0.12 and always above 0.25. Good: what noise leaves
/// over, sqrt(residual² − noise²), is at most 0.07, and the fit is not poor. Fair: between them.
inline FitQuality fit_quality(double residual, double noise) {
    constexpr double poor_in_noise = 2;
    constexpr double poor_without_noise = 0.12;
    constexpr double always_poor = 0.25;
    constexpr double good_misfit = 0.07;
    if (residual > std::clamp(poor_in_noise * noise, poor_without_noise, always_poor)) {
        return FitQuality::poor;
    }
    return residual <= std::hypot(noise, good_misfit) ? FitQuality::good : FitQuality::fair;
}

}  // namespace grainfield
