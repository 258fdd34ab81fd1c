#include "tracking/synthesis/corrected_positions.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "core/support/parallel.h"
#include "tracking/refine/edge_residuals.h"

namespace grainfield::tracking {
namespace {

constexpr std::int64_t kTogether = 64;  // spheres that a thread takes at a time

double noise_of(const Located& found, std::size_t sphere, double harmless = 0) {
    return effective_noise(found.noise, found.correlation, found.edge_residual[sphere], harmless);
}

void for_all(std::size_t count, int threads, const std::function<void(std::size_t)>& each) {
    const auto n = static_cast<std::int64_t>(count);
    parallel_for((n + kTogether - 1) / kTogether, threads, [&](std::int64_t block) {
        const std::int64_t end = std::min(n, (block + 1) * kTogether);
        for (std::int64_t i = block * kTogether; i < end; ++i) each(static_cast<std::size_t>(i));
    });
}

}  // namespace

std::vector<Vec2> standard_errors(const Located& found, const std::vector<double>& harmless) {
    std::vector<Vec2> errors = found.error;
    for (std::size_t i = 0; i < errors.size(); ++i) {
        errors[i] *= noise_of(found, i, harmless.empty() ? 0 : harmless[i]);
    }
    return errors;
}
void correct_bias(const BiasCorrection& correction, const Image& darkness, const Image& residual,
                  double diameter, Located& found, int threads) {
    const BiasCorrector corrector(correction, darkness, residual, found.fitted, diameter);
    for_all(found.position.size(), threads, [&](std::size_t i) {
        const Vec2 place = found.position[i];
        if (!corrector.reaches(place)) return;
        const auto [corrected, nearest] = corrector.corrected_within(place);
        const double noise = noise_of(found, i);
        if (correction.is_general()) {
            // GeneralCorrection::shares
            const double share =
                std::max(correction.shares[overlap_class(nearest)], found.noise / noise);
            const Vec2 shift = (correction.doubt / noise) * (corrected - place);
            Vec2& error = found.error[i];
            error = {std::hypot(share * error.x, shift.x), std::hypot(share * error.y, shift.y)};
        } else {
            const std::size_t kind = class_of(correction, nearest, found.residual[i]);
            const double error = correction.remaining[kind] * diameter / noise;
            found.error[i] = {error, error};
        }
        found.position[i] = corrected;
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
