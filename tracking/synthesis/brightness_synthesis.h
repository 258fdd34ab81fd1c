#pragma once

#include <vector>

#include "core/frame.h"
#include "core/vec2.h"
#include "tracking/synthesis/frame_light.h"
#include "tracking/synthesis/mirror_optics.h"
#include "tracking/synthesis/sphere_errors.h"

namespace grainfield::tracking {

/// Where the fit of one image begins.
struct BrightnessStart {
    std::vector<Point3> spheres;  ///< [a]
    bool are_heights_known = false;
    MirrorOptics optics;
    bool are_optics_known = false;  ///< else estimated from the image
    bool wants_overlap_factor = false;
};

/// What the fit of one image found; one entry a sphere.
struct BrightnessSynthesis {
    std::vector<Point3> spheres;      ///< [a]
    std::vector<SphereError> error;   ///< of the fit, whether in doubt or not
    double overlap_factor = 1;        ///< 1 where it is not wanted
    std::vector<char> is_doubtful;    ///< about it image and rendering differ unusually
    std::vector<Vec2> way_from_disc;  ///< of doubtful ones, to the start that was nearest [a]
    MirrorOptics optics;
    OpticsErrors optics_error;  ///< zeros: the optics were known
    UnevenLight uneven;         ///< what was evened out; light and residual are of what is left
    FrameLight light;
    Image residual;              ///< evened image − rendering
    double residual_before = 0;  ///< RMS at the start [contrast]
    double residual_rms = 0;     ///< … at the end
    double unexplained = 0;      ///< of it what neighbouring pixels share (coherent_rms)
    int rounds = 0, trials = 0, added = 0, removed = 0, lifted = 0;
};

/// Synthesis of an image that is brightness already: heights from none, optics, Gauss–Newton, the
/// search for other arrangements, and the last rounds with many rays. In between the light is
/// evened out three times, with nodes 12 diameters apart. `brightness` and `ceiling`:
/// see SynthesisFit. `height`: of the cell [a]. `searches`: most rounds of the search.
BrightnessSynthesis synthesise_brightness(const Image& brightness, const Image& ceiling,
                                          double diameter, const BrightnessStart& start,
                                          double height, int searches, int threads);

}  // namespace grainfield::tracking
