#pragma once

#include <cmath>
#include <vector>

#include "core/vec2.h"
#include "tracking/model/disc_profile.h"
#include "tracking/model/padded_image.h"

// What the kernels of one disc are held to, and the scene they are tried on.
namespace grainfield::tracking {

inline const DiscProfile kDisc{9, 1.25};
inline const std::vector<Vec2> kCentres{{12.3, 11.8}, {18.9, 14.2}, {1.2, 25.4}, {30.8, 30.1}};

/// The plain reference, in double precision.
inline double oracle_transmission(double r) {
    return r < kDisc.reach() ? 1 - kDisc.darkness(r) : 1.0;
}

inline double oracle_misfit(const PaddedImage& darkness, const std::vector<Vec2>& centres) {
    double sum = 0;
    for (int y = 0; y < darkness.height(); ++y) {
        for (int x = 0; x < darkness.width(); ++x) {
            double t = 1;
            for (const Vec2 c : centres) t *= oracle_transmission(std::hypot(x - c.x, y - c.y));
            const double r = static_cast<double>(darkness(x, y)) - 1 + t;
            sum += r * r;
        }
    }
    return sum;
}

}  // namespace grainfield::tracking
