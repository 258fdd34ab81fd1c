#include "tracking/synthesis/bias_correction.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>

#include "core/support/parallel.h"
#include "tracking/synthesis/bias_terms.h"

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

}  // namespace

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
    const BiasTerms terms(darkness, residual, found.fitted, diameter);
    std::vector<float> weights(correction.weights.begin(), correction.weights.end());
    const double reach = BiasTerms::kReach * diameter;
    const auto count = static_cast<std::int64_t>(found.position.size());
    const auto correct = [&](std::size_t i) {
        Vec2& place = found.position[i];
        if (std::min({place.x, place.y, darkness.width() - 1 - place.x,
                      darkness.height() - 1 - place.y}) < reach) {
            return;
        }
        const double nearest = terms.nearest(place);
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
        place += diameter * terms.weighted(place, weights);
    };
    parallel_for((count + kTogether - 1) / kTogether, threads, [&](std::int64_t block) {
        const std::int64_t end = std::min(count, (block + 1) * kTogether);
        for (std::int64_t i = block * kTogether; i < end; ++i) correct(static_cast<std::size_t>(i));
    });
}

}  // namespace grainfield::tracking
