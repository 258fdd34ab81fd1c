#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "bench/tracking/mirror_lessons.h"
#include "tracking/synthesis/general_correction.h"

namespace grainfield::bench {

/// What is left of the standard errors of discs (GeneralCorrection::shares, doubt).
struct RemainingErrors {
    std::vector<double> shares;
    double doubt = 0;
};

/// Errors of one camera while it is left out, RMS per axis [a].
struct CameraErrors {
    double before = 0;  ///< of the discs
    double after = 0;   ///< with the correction
    double within = 0;  ///< share within two of the standard errors that remain
};

struct MirrorRegression {
    std::vector<std::array<double, tracking::GeneralCorrection::kFilmTerms>> weights;  ///< of all
    double ridge = 0;                   ///< with the least errors on cameras left out
    RemainingErrors errors;             ///< of cameras left out
    std::vector<CameraErrors> cameras;  ///< one a lesson
};

/// Ridge regression of the errors of positions on BiasTerms, every kFolds-th camera left out in
/// turn. What is tried is printed on standard error.
MirrorRegression regress(const std::vector<MirrorLesson>& lessons);

}  // namespace grainfield::bench
