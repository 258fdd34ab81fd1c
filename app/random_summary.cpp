#include "app/random_summary.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "report/text.h"

namespace grainfield::app {

namespace {

using nlohmann::ordered_json;
using pipelines::DrawnScene;
using pipelines::SceneQuantity;
using pipelines::SceneScore;
using pipelines::SceneSpread;
using report::number_text;

/// NaN has no place in JSON.
ordered_json number(double value) {
    return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

ordered_json camera_facts(const DrawnScene& drawn) {
    ordered_json facts;
    facts["panel_distance_a"] = drawn.panel_distance;
    facts["reflectivity"] = drawn.reflectivity;
    facts["blur_a"] = drawn.blur;
    facts["aperture_rad"] = drawn.aperture;
    facts["distance_sides"] = drawn.distance ? ordered_json(*drawn.distance) : nullptr;
    facts["vignetting"] = drawn.vignetting;
    facts["level"] = drawn.level;
    facts["noise"] = drawn.noise;
    facts["stray"] = drawn.stray;
    facts["scale_px"] = drawn.scale;
    facts["density"] = drawn.density;
    facts["crystal_share"] = drawn.crystal ? ordered_json(drawn.crystal->share) : nullptr;
    facts["crystal_spacing_a"] = drawn.crystal ? ordered_json(drawn.crystal->spacing) : nullptr;
    facts["crystal_periods"] = drawn.crystal ? ordered_json(drawn.crystal->periods) : nullptr;
    facts["amplitude_a"] = drawn.amplitude;
    facts["phase_periods"] = drawn.phase;
    facts["walls_seen"] = drawn.walls_seen;
    facts["seed"] = drawn.seed;
    return facts;
}

ordered_json scene_facts(const SceneScore& scene) {
    ordered_json facts;
    facts["scene"] = scene.index;
    facts["calibrated"] = scene.is_calibrated;
    facts["spheres"] = scene.spheres;
    facts["missed"] = scene.missed;
    facts["false"] = scene.spurious;
    for (const SceneQuantity& q : pipelines::scene_quantities()) facts[q.key] = number(q.of(scene));
    facts["diameter_px"] = scene.disc.diameter;
    facts["edge_width_px"] = scene.disc.edge_width;
    facts["camera"] = camera_facts(scene.drawn);
    return facts;
}

}  // namespace

ordered_json random_facts(const pipelines::RandomValidationResult& result) {
    ordered_json facts;
    facts["frames"] = result.scenes.size();
    for (const SceneQuantity& q : pipelines::scene_quantities()) {
        const SceneSpread spread = pipelines::spread_of(result.scenes, q);
        facts["median"][q.key] = number(spread.median);
        facts["worst"][q.key] = number(spread.worst);
    }
    facts["scenes"] = ordered_json::array();
    for (const SceneScore& scene : result.scenes) facts["scenes"].push_back(scene_facts(scene));
    facts["thresholds"] = ordered_json::array();
    for (const auto& c : result.checks) {
        facts["thresholds"].push_back(
            {{"name", c.name}, {"limit", c.limit}, {"value", number(c.value)}, {"met", c.met()}});
    }
    return facts;
}

std::string random_text(const std::string& output,
                        const pipelines::RandomValidationResult& result) {
    std::string text = fmt::format("{}: {} scenes\n  {:<22}{:>12}{:>12}\n", output,
                                   result.scenes.size(), "", "median", "worst");
    std::int64_t missed = 0;
    std::int64_t spurious = 0;
    std::int64_t spheres = 0;
    for (const SceneScore& scene : result.scenes) {
        missed += scene.missed;
        spurious += scene.spurious;
        spheres += scene.spheres;
    }
    for (const SceneQuantity& q : pipelines::scene_quantities()) {
        const SceneSpread spread = pipelines::spread_of(result.scenes, q);
        const std::string name = q.unit.empty() ? q.label : q.label + " [" + q.unit + "]";
        text += fmt::format("  {:<22}{:>12}{:>12}{}\n", name, number_text(spread.median, "{:.5g}"),
                            number_text(spread.worst, "{:.5g}"),
                            q.right.empty() ? "" : "   right: " + q.right);
    }
    text += fmt::format("  all: {} missed and {} false of {}\n", missed, spurious, spheres);
    if (!result.scenes.empty()) {
        const SceneScore& worst =
            *std::min_element(result.scenes.begin(), result.scenes.end(), pipelines::is_worse);
        text += fmt::format("  worst: scene {}, {} missed and {} false of {}\n", worst.index,
                            worst.missed, worst.spurious, worst.spheres);
    }
    for (const auto& c : result.checks) {
        text += fmt::format("  {:<10}{}\n", c.met() ? "met" : "MISSED", c.text());
    }
    return text;
}

}  // namespace grainfield::app
