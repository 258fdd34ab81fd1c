#include "pipelines/tune/tuning.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tracking/layers/overlap_graph.h"

namespace grainfield::pipelines {

namespace {

using tracking::Survey;

double median(std::vector<double> values) {
    std::erase_if(values, [](double v) { return !std::isfinite(v); });
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

double Tuning::particles_mean() const {
    double sum = 0;
    for (const Survey& survey : surveys) sum += static_cast<double>(survey.found.position.size());
    return sum / std::max<double>(1, static_cast<double>(surveys.size()));
}

double Tuning::residual_rms() const {
    double sum = 0;
    for (const Survey& survey : surveys) sum += survey.found.residual_rms;
    return sum / std::max<double>(1, static_cast<double>(surveys.size()));
}

double Tuning::noise() const {
    double sum = 0;
    for (const Survey& survey : surveys) sum += survey.found.noise;
    return sum / std::max<double>(1, static_cast<double>(surveys.size()));
}

double Tuning::diameter() const {
    return options.sphere_diameter.value_or(model.disc.diameter);
}

double Tuning::forbidden_distance() const {
    if (!options.layers.height || !options.sphere_diameter) return 0;
    const tracking::SphereCell cell{.height = *options.layers.height};
    return *options.sphere_diameter * cell.least_distance();
}

std::vector<double> Tuning::gathered(
    const std::function<std::vector<double>(const Survey&)>& of) const {
    std::vector<double> all;
    for (const Survey& survey : surveys) {
        const std::vector<double> values = of(survey);
        all.insert(all.end(), values.begin(), values.end());
    }
    return all;
}

double Tuning::median_error() const {
    return median(gathered([](const Survey& survey) {
        std::vector<double> values;
        for (const Vec2 e : survey.error) values.push_back(norm(e) / std::sqrt(2.0));
        return values;
    }));
}

}  // namespace grainfield::pipelines
