#pragma once

#include <vector>

#include "core/frame.h"
#include "tracking/synthesis/mirror_optics.h"

namespace grainfield::tracking {

/// What a frame shows of mirror-like spheres; see SynthesisFit.
struct OpticsFrame {
    const Image& brightness;
    const Image& ceiling;
    double scale;  ///< [px/a]
};

struct FittedOptics {
    MirrorOptics optics;
    OpticsErrors error;
};

/// F0, blur, ambient and grazing with which these spheres [a] look most like the frame, by two
/// rounds of Gauss–Newton from `optics`; all else stays.
///
/// Nine squares of 7 diameters, spread over the frame, decide together, each with a light of its
/// own. In a frame less than 21 diameters in either direction it is one square of at most 16 in the
/// middle. Pixels at the ceiling and those that the rendering is far from have no say.
///
/// Errors are those of A⁻¹ (Σ s sᵀ) A⁻¹ (`liangzeger1986`), A the information matrix and s the
/// score of each block of 1.5 × 1.5 diameters: they hold what is left over, with its correlation
/// within a block. What is wrong alike in all blocks is not in them. A wrong diameter is such, and
/// heights with errors: .03 a of them lower F0 by .013, where the error is .004. Grazing changes
/// few rays at once, so its error is the least certain. Fewer than 9 blocks a square: errors are 0.
FittedOptics fitted_optics(const OpticsFrame& frame, const std::vector<Point3>& spheres,
                           MirrorOptics optics, int threads);

}  // namespace grainfield::tracking
