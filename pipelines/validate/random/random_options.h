#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/option_table.h"
#include "pipelines/validate/random/drawn_scene.h"
#include "pipelines/validate/validation_thresholds.h"
#include "simulate/render/optics/optics.h"

namespace grainfield::pipelines {

/// What a validation over cameras drawn at random is asked for. Section `random`.
struct RandomOpticsOptions {
    int scenes = 20;
    SceneSize scene_size = SceneSize::full;
    double crystals = 0;  ///< share of the layers with a square crystal in the middle [-]
    std::string keep;     ///< folder for frames, truth and cameras; empty: not kept
};

/// What the median and the worst of the scenes have to reach; what is not set is not checked.
/// Section `random-threshold`.
struct RandomThresholds {
    std::optional<double> median_recall;  ///< least [-]
    std::optional<double> worst_recall;   ///< least [-]
    std::optional<double> median_false;   ///< largest, false / true spheres [-]
    std::optional<double> worst_false;    ///< largest [-]
    std::optional<double> median_rmse;    ///< largest per axis [a]
    std::optional<double> worst_rmse;     ///< largest per axis [a]
    std::optional<double> median_within;  ///< least share of errors within 2σ [-]
};

OptionTable describe(RandomThresholds& thresholds);

/// Among the optics of a validation: a camera and a layer for each scene, drawn (draw_scene). It
/// makes no images itself; the optics of a scene are those of camera_of.
class RandomOptics final : public simulate::OpticsKindOf<RandomOptics>, public RandomOpticsOptions {
 public:
    std::string name() const override { return "random"; }
    std::string meaning() const override {
        return "a ray-traced scene for each camera that is drawn";
    }
    std::string title() const override { return "ray tracing by cameras drawn at random"; }
    OptionTable describe() override;
    /// Throws OptionError: there is not one camera.
    std::unique_ptr<simulate::Optics> make(double noise, int threads) const override;
    bool samples() const override { return true; }
};

}  // namespace grainfield::pipelines
