#include "pipelines/validate/random/random_scores.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace grainfield::pipelines {

namespace {

const SceneQuantity& quantity(const std::string& key) {
    const auto& all = scene_quantities();
    return *std::find_if(all.begin(), all.end(), [&](const auto& q) { return q.key == key; });
}

double wrong_share(const SceneScore& scene) {
    return static_cast<double>(scene.missed + scene.spurious) /
           static_cast<double>(std::max<std::int64_t>(1, scene.spheres));
}

}  // namespace

const std::vector<SceneQuantity>& scene_quantities() {
    static const std::vector<SceneQuantity> all{
        {"recall", "Recall", "", true, [](const SceneScore& s) { return s.recall(); }},
        {"false_share", "False a true sphere", "", false,
         [](const SceneScore& s) { return s.false_share(); }},
        {"rmse_a", "RMSE", "a", false, [](const SceneScore& s) { return s.rmse; }},
        {"pull_rms", "Pull", "", false, [](const SceneScore& s) { return s.pull_rms; }, "1"},
        {"within_2_sigma", "Within 2σ", "", true, [](const SceneScore& s) { return s.within; },
         "0.954"},
        {"residual_rms", "Residual", "contrast", false,
         [](const SceneScore& s) { return s.residual; }},
        {"us_per_sphere", "Time a sphere", "µs", false,
         [](const SceneScore& s) { return s.us_per_sphere; }}};
    return all;
}

SceneSpread spread_of(const std::vector<SceneScore>& scenes, const SceneQuantity& quantity) {
    std::vector<double> values;
    for (const SceneScore& scene : scenes) {
        const double value = quantity.of(scene);
        if (std::isfinite(value)) values.push_back(value);
    }
    if (values.empty()) {
        constexpr double nan = std::numeric_limits<double>::quiet_NaN();
        return {nan, nan};
    }
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    return {(values[(n - 1) / 2] + values[n / 2]) / 2,
            quantity.is_least_worst ? values.front() : values.back()};
}

bool is_worse(const SceneScore& a, const SceneScore& b) {
    // A scene without any error to speak of has no RMSE; it is the worst of its kind.
    const auto error = [](const SceneScore& s) {
        return std::isfinite(s.rmse) ? s.rmse : std::numeric_limits<double>::infinity();
    };
    return std::tuple(-wrong_share(a), -error(a), a.index) <
           std::tuple(-wrong_share(b), -error(b), b.index);
}

std::vector<ThresholdCheck> check(const RandomThresholds& t,
                                  const std::vector<SceneScore>& scenes) {
    std::vector<ThresholdCheck> checks;
    const auto add = [&](const char* name, const char* unit, const std::optional<double>& limit,
                         double value, bool is_least) {
        if (limit) checks.push_back({name, unit, *limit, value, is_least});
    };
    const SceneSpread recall = spread_of(scenes, quantity("recall"));
    const SceneSpread spurious = spread_of(scenes, quantity("false_share"));
    const SceneSpread rmse = spread_of(scenes, quantity("rmse_a"));
    add("median-recall", "-", t.median_recall, recall.median, true);
    add("worst-recall", "-", t.worst_recall, recall.worst, true);
    add("median-false", "-", t.median_false, spurious.median, false);
    add("worst-false", "-", t.worst_false, spurious.worst, false);
    add("median-rmse", "a", t.median_rmse, rmse.median, false);
    add("worst-rmse", "a", t.worst_rmse, rmse.worst, false);
    add("median-within", "-", t.median_within, spread_of(scenes, quantity("within_2_sigma")).median,
        true);
    return checks;
}

}  // namespace grainfield::pipelines
