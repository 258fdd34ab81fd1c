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

/// F0, blur, ambient and grazing with which these spheres [a] look most like the frame, by two
/// rounds of Gauss–Newton from `optics`; all else stays.
///
/// Nine squares of 7 diameters, spread over the frame, decide together, each with a light of its
/// own. In a frame less than 21 diameters in either direction it is one square of at most 16 in the
/// middle. Pixels at the ceiling and those that the rendering is far from have no say.
MirrorOptics fitted_optics(const OpticsFrame& frame, const std::vector<Point3>& spheres,
                           MirrorOptics optics, int threads);

}  // namespace grainfield::tracking
