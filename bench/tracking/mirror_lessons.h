#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Dense>

#include "bench/tracking/mirror_patterns.h"
#include "tracking/synthesis/bias_terms.h"

namespace grainfield::bench {

inline constexpr Eigen::Index kTerms = tracking::BiasTerms::kCount;

/// What one camera teaches: rows are spheres along x, then along y.
struct MirrorLesson {
    std::string name;
    double width = 0, diameter = 0;  ///< of the discs [a]
    Eigen::MatrixXf terms;
    Eigen::VectorXd lacks, error;  ///< truth − found, and its standard error [a]
    Eigen::VectorXd least;         ///< error that the noise of the camera alone makes [a]
    std::vector<std::size_t> overlap;
    CameraPatterns patterns;

    std::size_t spheres() const { return overlap.size(); }
};

/// Of the scenes in folders that `validate --keep` wrote, each calibrated and searched as `track`
/// does it. Scenes that cannot be calibrated, or of which no sphere is found, are left out and
/// named on standard error.
std::vector<MirrorLesson> lessons_in(const std::vector<std::string>& folders);

}  // namespace grainfield::bench
