#pragma once

#include <functional>
#include <vector>

#include "tracking/survey.h"
#include "tracking/tracker.h"

namespace grainfield::pipelines {

/// What was seen of some frames of a film, each located on its own.
struct Tuning {
    const tracking::ImageModel& model;
    const tracking::TrackOptions& options;
    const std::vector<tracking::Survey>& surveys;

    double particles_mean() const;
    double residual_rms() const;  ///< mean over the frames [contrast]
    double noise() const;         ///< of the camera, mean over the frames [contrast]
    /// Unit of the analysis: the sphere, or its disc [px].
    double diameter() const;
    /// No two spheres are closer in projection [px]; 0 without a height of the cell.
    double forbidden_distance() const;
    /// Of the standard errors per axis [px]; NaN if there are none.
    double median_error() const;

    /// One value a sphere, of all frames.
    std::vector<double> gathered(
        const std::function<std::vector<double>(const tracking::Survey&)>& of) const;
};

}  // namespace grainfield::pipelines
