#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pipelines/validate/random/random_options.h"
#include "pipelines/validate/random/scene_score.h"

namespace grainfield::pipelines {

/// One quantity of the scenes that a validation over random cameras reports.
struct SceneQuantity {
    std::string key;    ///< in JSON and CSV
    std::string label;  ///< for people
    std::string unit;
    bool is_least_worst = false;  ///< the smallest value is the worst; else the largest
    std::function<double(const SceneScore&)> of;
    std::string right = {};  ///< the value where errors are as reported; empty: the best is right
};

/// Recall, share of false spheres, RMSE, pulls, share within 2σ, residual, time a sphere.
const std::vector<SceneQuantity>& scene_quantities();

/// Median and worst over the scenes in which the quantity was measured; NaN if there is none. A
/// scene that could not be calibrated counts with recall 0.
struct SceneSpread {
    double median = 0;
    double worst = 0;
};
SceneSpread spread_of(const std::vector<SceneScore>& scenes, const SceneQuantity& quantity);

/// From the worst on: the greatest share of missed and false spheres together, then the greater
/// RMSE, then the smaller index.
bool is_worse(const SceneScore& a, const SceneScore& b);

/// The thresholds that are set, in the order of their table.
std::vector<ThresholdCheck> check(const RandomThresholds& thresholds,
                                  const std::vector<SceneScore>& scenes);

}  // namespace grainfield::pipelines
