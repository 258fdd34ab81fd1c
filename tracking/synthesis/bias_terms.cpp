#include "tracking/synthesis/bias_terms.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace grainfield::tracking {
namespace {

constexpr int kAngles = 24;
constexpr std::array<double, BiasTerms::kRings> kRadius = {0.15, 0.3, 0.45, 0.6, 0.75, 0.9, 1.1};
constexpr std::array<double, BiasTerms::kDistances> kDistance = {
    0.35, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.45, 1.7, 2.0};  // [a]
constexpr double kFarthest = 2.3;                                    // [a] where the last φ is 0
constexpr double kItself = 0.1;                                      // [a]

/// cos mθ and sin mθ over the number of angles.
struct Waves {
    std::array<std::array<float, kAngles>, BiasTerms::kOrders> cosine, sine;
    Waves() {
        for (std::size_t m = 0; m < BiasTerms::kOrders; ++m) {
            for (std::size_t k = 0; k < kAngles; ++k) {
                const double phase =
                    2 * std::numbers::pi * static_cast<double>(m * k) / double{kAngles};
                cosine[m][k] = static_cast<float>(std::cos(phase) / kAngles);
                sine[m][k] = static_cast<float>(std::sin(phase) / kAngles);
            }
        }
    }
};

const Waves& waves() {
    static const Waves kept;
    return kept;
}

/// Bilinear; the place lies within the image.
float value_at(const Image& image, double x, double y) {
    const int u = std::clamp(static_cast<int>(x), 0, image.width() - 2);
    const int v = std::clamp(static_cast<int>(y), 0, image.height() - 2);
    const auto fx = static_cast<float>(x - u);
    const auto fy = static_cast<float>(y - v);
    const float* upper = image.row(v) + u;
    const float* lower = image.row(v + 1) + u;
    const float above = upper[0] + fx * (upper[1] - upper[0]);
    const float below = lower[0] + fx * (lower[1] - lower[0]);
    return above + fy * (below - above);
}

struct Moments {
    std::array<std::array<float, BiasTerms::kSources>, BiasTerms::kOrders> real, imaginary;
};

void add_ring(const Image& image, Vec2 centre, double radius, std::size_t source,
              Moments& moments) {
    const Waves& wave = waves();
    std::array<float, kAngles> value;
    for (std::size_t k = 0; k < kAngles; ++k) {
        const auto along = static_cast<double>(wave.cosine[1][k]) * kAngles;
        const auto across = static_cast<double>(wave.sine[1][k]) * kAngles;
        value[k] = value_at(image, centre.x + radius * along, centre.y + radius * across);
    }
    for (std::size_t m = 0; m < BiasTerms::kOrders; ++m) {
        float real = 0;
        float imaginary = 0;
        for (std::size_t k = 0; k < kAngles; ++k) {
            real += value[k] * wave.cosine[m][k];
            imaginary += value[k] * wave.sine[m][k];
        }
        moments.real[m][source] = real;
        moments.imaginary[m][source] = imaginary;
    }
}

}  // namespace

BiasTerms::BiasTerms(const Image& darkness, const Image& residual, const std::vector<Vec2>& discs,
                     double diameter)
    : darkness_(darkness), residual_(residual), diameter_(diameter) {
    if (!discs.empty()) grid_.emplace(discs, kFarthest * diameter);
}

BiasTerms::Terms BiasTerms::of(Vec2 place) const {
    Terms terms;
    std::size_t next = 0;
    const auto add = [&](float x, float y) {
        terms.x[next] = x;
        terms.y[next] = y;
        ++next;
    };
    std::array<Vec2, kDistances> sum{};
    const auto add_neighbour = [&](std::uint32_t, Vec2 disc) {
        const Vec2 apart = (1 / diameter_) * (disc - place);
        const double d = norm(apart);
        if (d < kItself) return;
        const Vec2 direction = (1 / d) * apart;
        for (std::size_t k = 0; k < kDistances; ++k) {
            const double here = kDistance[k];
            const double before = k > 0 ? kDistance[k - 1] : 2 * here - kDistance[1];
            const double after = k + 1 < kDistances ? kDistance[k + 1] : kFarthest;
            const double share = std::min((d - before) / (here - before),  //
                                          (after - d) / (after - here));
            if (share > 0) sum[k] = sum[k] + share * direction;
        }
    };
    if (grid_) grid_->near(place, kFarthest * diameter_, add_neighbour);
    for (const Vec2 s : sum) add(static_cast<float>(s.x), static_cast<float>(s.y));

    Moments h;
    for (std::size_t ring = 0; ring < kRings; ++ring) {
        add_ring(residual_, place, kRadius[ring] * diameter_, ring, h);
        add_ring(darkness_, place, kRadius[ring] * diameter_, kRings + ring, h);
    }
    for (std::size_t s = 0; s < kSources; ++s) add(h.real[1][s], h.imaginary[1][s]);
    for (std::size_t m = 0; m + 1 < kOrders; ++m) {
        for (std::size_t p = 0; p < kSources; ++p) {
            const float a = h.real[m + 1][p];
            const float b = h.imaginary[m + 1][p];
            for (std::size_t q = 0; q < kSources; ++q) {
                const float c = h.real[m][q];
                const float d = h.imaginary[m][q];
                terms.x[next] = a * c + b * d;
                terms.y[next] = b * c - a * d;
                ++next;
            }
        }
    }
    return terms;
}

double BiasTerms::nearest(Vec2 place) const {
    double least = kFarthest * diameter_;
    if (!grid_) return kFarthest;
    grid_->near(place, least, [&](std::uint32_t, Vec2 disc) {
        const double d = norm(disc - place);
        if (d >= kItself * diameter_) least = std::min(least, d);
    });
    return least / diameter_;
}

}  // namespace grainfield::tracking
