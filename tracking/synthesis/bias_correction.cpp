#include "tracking/synthesis/bias_correction.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <utility>

#include "core/support/parallel.h"
#include "tracking/locate.h"

namespace grainfield::tracking {
namespace {

constexpr std::int64_t kTogether = 64;  // spheres that a thread takes at a time

/// What the camera's noise and the misfit of the model make of an error of one per unit noise.
double noise_of(const Located& found, std::size_t sphere, double harmless = 0) {
    // Where the image model is wrong, its misfit limits the position beside the camera's noise,
    // and it is alike in neighbouring pixels.
    const double noise = found.noise * found.noise;
    const double misfit =
        std::max(0.0, found.residual[sphere] * found.residual[sphere] - noise - harmless);
    return std::sqrt(noise + found.correlation * misfit);
}

void for_all(std::size_t count, int threads, const std::function<void(std::size_t)>& each) {
    const auto n = static_cast<std::int64_t>(count);
    parallel_for((n + kTogether - 1) / kTogether, threads, [&](std::int64_t block) {
        const std::int64_t end = std::min(n, (block + 1) * kTogether);
        for (std::int64_t i = block * kTogether; i < end; ++i) each(static_cast<std::size_t>(i));
    });
}

}  // namespace

BiasCorrector::BiasCorrector(BiasTerms terms, const BiasCorrection& correction, double diameter,
                             int width, int height)
    : terms_(std::move(terms)),
      weights_(correction.weights.begin(), correction.weights.end()),
      diameter_(diameter),
      width_(width),
      height_(height) {}

BiasCorrector::BiasCorrector(const BiasCorrection& correction, const Image& darkness,
                             const Image& residual, const std::vector<Vec2>& discs, double diameter)
    : BiasCorrector(BiasTerms(darkness, residual, discs, diameter), correction, diameter,
                    darkness.width(), darkness.height()) {}

BiasCorrector::BiasCorrector(const BiasCorrection& correction, const PaddedImage& darkness,
                             const PaddedImage& transmission, const std::vector<Vec2>& discs,
                             double diameter)
    : BiasCorrector(BiasTerms(darkness, transmission, discs, diameter), correction, diameter,
                    darkness.width(), darkness.height()) {}

bool BiasCorrector::reaches(Vec2 place) const {
    const double inside = std::min({place.x, place.y, width_ - 1 - place.x, height_ - 1 - place.y});
    return inside >= BiasTerms::kReach * diameter_;
}

Vec2 BiasCorrector::corrected(Vec2 place) const {
    return reaches(place) ? place + diameter_ * terms_.weighted(place, weights_) : place;
}

std::vector<Vec2> standard_errors(const Located& found, const std::vector<double>& harmless) {
    std::vector<Vec2> errors = found.error;
    for (std::size_t i = 0; i < errors.size(); ++i) {
        errors[i] *= noise_of(found, i, harmless.empty() ? 0 : harmless[i]);
    }
    return errors;
}

std::size_t overlap_class(double nearest) {
    return static_cast<std::size_t>(
        std::upper_bound(std::begin(kOverlapBounds), std::end(kOverlapBounds), nearest) -
        std::begin(kOverlapBounds));
}

std::size_t class_of(const BiasCorrection& correction, double nearest, double residual) {
    const auto quality =
        std::upper_bound(correction.quality.begin(), correction.quality.end(), residual) -
        correction.quality.begin();
    return overlap_class(nearest) * kQualityClasses + static_cast<std::size_t>(quality);
}

void correct_bias(const BiasCorrection& correction, const Image& darkness, const Image& residual,
                  double diameter, Located& found, int threads) {
    const BiasCorrector corrector(correction, darkness, residual, found.fitted, diameter);
    for_all(found.position.size(), threads, [&](std::size_t i) {
        const Vec2 place = found.position[i];
        if (!corrector.reaches(place)) return;
        const double nearest = corrector.terms().nearest(place);
        const double noise = noise_of(found, i);
        if (correction.is_general()) {
            // Less than the camera's noise alone makes never remains.
            found.error[i] *=
                std::max(correction.shares[overlap_class(nearest)], found.noise / noise);
        } else {
            const std::size_t kind = class_of(correction, nearest, found.residual[i]);
            const double error = correction.remaining[kind] * diameter / noise;
            found.error[i] = {error, error};
        }
        found.position[i] = corrector.corrected(place);
    });
}

std::vector<Vec2> corrected_discs(const BiasCorrection& correction, const Image& darkness,
                                  const Image& residual, double diameter, const Located& found,
                                  int threads) {
    const BiasCorrector corrector(correction, darkness, residual, found.fitted, diameter);
    std::vector<Vec2> discs = found.fitted;
    for_all(discs.size(), threads,
            [&](std::size_t i) { discs[i] = corrector.corrected(discs[i]); });
    return discs;
}

}  // namespace grainfield::tracking
