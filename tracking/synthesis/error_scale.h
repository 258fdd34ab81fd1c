#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/frame.h"
#include "core/support/number_archive.h"
#include "tracking/synthesis/brightness_synthesis.h"

namespace grainfield::tracking {

/// What standard errors of the fit (sphere_errors) are to be multiplied by.
///
/// By class of overlap: 0 for spheres whose nearest neighbour in the picture is nearer than
/// kOverlapping, 1 for the others.
struct ErrorScale {
    static constexpr double kOverlapping = 0.85;  ///< [a]
    static constexpr std::size_t kLeast = 30;     ///< spheres that a factor is learned from
    std::array<double, 2> plane = {1, 1};
    std::array<double, 2> height = {1, 1};
    std::int64_t spheres = 0;  ///< learned from; 0: not learned, all factors 1

    friend bool operator==(const ErrorScale&, const ErrorScale&) = default;
};

/// The least factors, by class, that put as many errors within σ and 2σ as a Gaussian has there:
/// the larger of the 68.3 % quantile and half the 95.4 % quantile of `ratios`, and no less than 1.
/// `ratios`: |error| / stated error by class, `per_sphere` of them a sphere, 1 or more in all.
/// Where a class has fewer than kLeast spheres both share a factor.
std::array<double, 2> error_factors(const std::array<std::vector<double>, 2>& ratios,
                                    std::size_t per_sphere);

/// The class of each sphere.
std::vector<std::size_t> overlap_classes(const std::vector<Point3>& spheres);

/// Learns the scale from an image whose truth is known, like the one that was fitted.
///
/// 1. The spheres found in the middle of the image, 14 a wide at most, are moved at random
///    (moved_at_random) and rendered under the optics and the light that were found.
/// 2. What the rendering left over is added, mirrored left to right about the middle: noise, and
///    what the model of the light lacks, with its correlation from pixel to pixel. Unmirrored it
///    lacks what the spheres followed there. Counts end at the ceiling.
/// 3. That image is fitted as the one before (synthesise_brightness): discs with the errors that
///    they had, no heights, optics from the same start.
/// 4. A factor is the least with which 68 % of the errors lie within σ and 95.4 % within 2σ, and no
///    less than 1. Errors of heights are about their mean difference. Doubtful spheres do not
///    count.
///
/// 5. Factors of heights are no less than `found.overlap_factor`: hard spheres cannot overlap, and
///    what the model of the light does wrong shows there and not in 1 to 4.
///
/// So it holds errors of the optics, of rounds that have not settled, of minima that look right and
/// of height that neighbours share. Of a wrong diameter it holds the overlaps, not the rest.
/// It does not hold a wrong height of the cell, nor what all heights are off together.
///
/// It is repeated until 160 spheres, 2 a or more within the part, have been judged, three times at
/// most. Below 30 in a class both share a factor; below 30 in all nothing is learned. Same bits for
/// any number of threads.
ErrorScale learn_error_scale(const Image& brightness, const Image& ceiling, double diameter,
                             const BrightnessStart& start, const BrightnessSynthesis& found,
                             double height, int searches, int threads);

/// Saves or restores.
void transfer(NumberArchive& archive, ErrorScale& scale);

}  // namespace grainfield::tracking
