#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/frame.h"
#include "core/support/random.h"
#include "core/vec2.h"
#include "tracking/model/disc_profile.h"
#include "tracking/refine/joint_fit.h"

// Discs that overlap, their image, and fits of it.
namespace grainfield::tracking {

/// 1 − Π t plus white noise, from the model in double precision.
inline Image darkness_of(const std::vector<Vec2>& centres, const DiscProfile& disc, int size,
                         double noise, std::uint64_t seed) {
    RandomStream random(seed, "joint fit noise");
    Image image(size, size);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            double t = 1;
            for (const Vec2 c : centres) t *= 1 - disc.darkness(std::hypot(x - c.x, y - c.y));
            image(x, y) = static_cast<float>(1 - t + noise * random.normal());
        }
    }
    return image;
}

inline JointFit started(const Image& darkness, const std::vector<Vec2>& centres,
                        const DiscProfile& disc, int threads, double off) {
    JointFit fit(darkness, disc, threads);
    RandomStream random(17, "start");
    for (const Vec2 c : centres) {
        fit.add(c + Vec2{random.uniform(-off, off), random.uniform(-off, off)});
    }
    return fit;
}

inline double rms(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += squared_norm(a[i] - b[i]);
    return std::sqrt(sum / (2.0 * static_cast<double>(a.size())));
}

inline std::vector<Vec2> square_patch(double spacing, int side, double origin, double jitter) {
    RandomStream random(23, "patch");
    std::vector<Vec2> centres;
    for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) {
            centres.push_back({origin + spacing * i + jitter * random.normal(),
                               origin + spacing * j + jitter * random.normal()});
        }
    }
    return centres;
}

/// Discs that overlap, swept until few hundredths of a pixel are left.
inline JointFit swept(const Image& darkness, const std::vector<Vec2>& truth,
                      const DiscProfile& disc) {
    JointFit fit = started(darkness, truth, disc, 2, 0.5);
    RefinementOptions rough;
    rough.tolerance = 0.03;
    fit.refine(rough);
    return fit;
}

}  // namespace grainfield::tracking
