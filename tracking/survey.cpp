#include "tracking/survey.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "core/support/parallel.h"
#include "tracking/point_grid.h"
#include "tracking/synthesis/corrected_positions.h"

namespace grainfield::tracking {
namespace {

/// What an isolated disc explains: Σ P² [contrast² px].
double isolated_evidence(const DiscProfile& disc) {
    const int half = static_cast<int>(std::ceil(disc.reach()));
    double sum = 0;
    for (int y = -half; y <= half; ++y) {
        for (int x = -half; x <= half; ++x) {
            const double p = disc.darkness(std::hypot(x, y));
            sum += p * p;
        }
    }
    return sum;
}

}  // namespace

Surveyor::Surveyor(const ImageModel& model, const TrackOptions& options, int width, int height)
    : model_(model),
      detection_(detection_of(options)),
      refinement_(options.refinement),
      visible_(options.visible),
      locator_(width, height, model, thread_count(options.threads)),
      illumination_(model, options.visible) {
    locator_.set_visible(options.visible);
    locator_.expect_misfit(model.residual_rms);
}

Survey Surveyor::look(const Frame& frame) {
    const Illumination light = illumination_.expected(frame.image);
    const Image darkness = model_.darkness(frame.image, light);
    Survey survey;
    survey.frame = frame.index;
    survey.found = locator_.locate(darkness, detection_, refinement_);
    illumination_.settled(frame.image, light, locator_.transmission());
    survey.residual = locator_.residual();
    const double isolated = isolated_evidence(model_.disc);
    const Located& found = survey.found;
    survey.error = standard_errors(found);
    for (std::size_t j = 0; j < found.position.size(); ++j) {
        survey.evidence.push_back(found.explained[j] / isolated);
    }
    survey.profile = exposed_profile(darkness, found.fitted, model_.disc, visible_);
    return survey;
}

std::vector<double> nearest_distances(const std::vector<Vec2>& points, double farthest) {
    std::vector<double> distances(points.size(), std::numeric_limits<double>::infinity());
    if (points.empty()) return distances;
    const PointGrid grid(points, farthest);
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        grid.near(points[i], farthest, [&](std::uint32_t j, Vec2 p) {
            if (j != i) distances[i] = std::min(distances[i], norm(p - points[i]));
        });
    }
    return distances;
}

PhaseBias phase_bias(const std::vector<Vec2>& points) {
    PhaseBias bias;
    if (points.empty()) return bias;
    std::complex<double> x = 0;
    std::complex<double> y = 0;
    for (const Vec2 p : points) {
        x += std::polar(1.0, 2 * std::numbers::pi * p.x);
        y += std::polar(1.0, 2 * std::numbers::pi * p.y);
    }
    const auto n = static_cast<double>(points.size());
    bias = {std::abs(x) / n, std::abs(y) / n, std::sqrt(std::numbers::pi / (4 * n))};
    return bias;
}

}  // namespace grainfield::tracking
