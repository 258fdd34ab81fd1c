#pragma once

#include <vector>

#include "core/frame.h"
#include "core/vec2.h"
#include "tracking/locate.h"
#include "tracking/synthesis/bias_correction.h"

namespace grainfield::tracking {

/// Corrects positions, and makes errors those of the scatter that remains; for a general correction
/// see GeneralCorrection::shares. Spheres nearer than BiasTerms::kReach to the border stay as
/// they are. `darkness` and `residual` are those of the fit that gave `found`, `diameter` is a
/// [px]. Same bits for any number of threads. About 3 µs a sphere.
void correct_bias(const BiasCorrection& correction, const Image& darkness, const Image& residual,
                  double diameter, Located& found, int threads);

/// Every disc of the model, those farther than BiasTerms::kReach from the border corrected [px].
std::vector<Vec2> corrected_discs(const BiasCorrection& correction, const Image& darkness,
                                  const Image& residual, double diameter, const Located& found,
                                  int threads);

/// Standard errors of what was found, misfit included [px]. `harmless`: what of the squared misfit
/// about each sphere displaces none [contrast²]; empty: nothing.
std::vector<Vec2> standard_errors(const Located& found, const std::vector<double>& harmless = {});

}  // namespace grainfield::tracking
