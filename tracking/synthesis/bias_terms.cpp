#include "tracking/synthesis/bias_terms.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <type_traits>

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

/// Where to read an image between pixels.
struct Between {
    int column, row;
    float right, below;  ///< shares of the next column and row

    /// A place within images of that size.
    template <class AnImage>
    Between(const AnImage& image, float x, float y)
        : column(std::clamp(static_cast<int>(x), 0, image.width() - 2)),
          row(std::clamp(static_cast<int>(y), 0, image.height() - 2)),
          right(x - static_cast<float>(column)),
          below(y - static_cast<float>(row)) {}

    template <class AnImage>
    float of(const AnImage& image) const {
        const float* upper = image.row(row) + column;
        const float* lower = image.row(row + 1) + column;
        const float first = upper[0] + right * (upper[1] - upper[0]);
        const float second = lower[0] + right * (lower[1] - lower[0]);
        return first + below * (second - first);
    }
};

}  // namespace

BiasTerms::BiasTerms(const Image& darkness, const Image& residual, const std::vector<Vec2>& discs,
                     double diameter)
    : images_(Given{&darkness, &residual}), diameter_(diameter) {
    if (!discs.empty()) grid_.emplace(discs, kFarthest * diameter);
}

BiasTerms::BiasTerms(const PaddedImage& darkness, const PaddedImage& transmission,
                     const std::vector<Vec2>& discs, double diameter)
    : images_(Fitted{&darkness, &transmission}), diameter_(diameter) {
    if (!discs.empty()) grid_.emplace(discs, kFarthest * diameter);
}

std::array<Vec2, BiasTerms::kDistances> BiasTerms::neighbours(Vec2 place) const {
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
    return sum;
}

/// `other`: the residual, or the transmission where the images are those of a fit.
template <class AnImage>
void BiasTerms::add_rings(const AnImage& dark, const AnImage& other, Vec2 place, Moments& h) const {
    const Waves& wave = waves();
    for (std::size_t ring = 0; ring < kRings; ++ring) {
        const auto radius = static_cast<float>(kRadius[ring] * diameter_);
        const auto x = static_cast<float>(place.x);
        const auto y = static_cast<float>(place.y);
        std::array<float, kAngles> residual;
        std::array<float, kAngles> darkness;
        for (std::size_t k = 0; k < kAngles; ++k) {
            const Between at(dark, x + radius * kAngles * wave.cosine[1][k],
                             y + radius * kAngles * wave.sine[1][k]);
            darkness[k] = at.of(dark);
            residual[k] = at.of(other);
            if constexpr (std::is_same_v<AnImage, PaddedImage>) residual[k] += darkness[k] - 1;
        }
        for (std::size_t m = 0; m < kOrders; ++m) {
            float a = 0;
            float b = 0;
            float c = 0;
            float d = 0;
#pragma omp simd reduction(+ : a, b, c, d)
            for (std::size_t k = 0; k < kAngles; ++k) {
                a += residual[k] * wave.cosine[m][k];
                b += residual[k] * wave.sine[m][k];
                c += darkness[k] * wave.cosine[m][k];
                d += darkness[k] * wave.sine[m][k];
            }
            h.real[m][ring] = a;
            h.imaginary[m][ring] = b;
            h.real[m][kRings + ring] = c;
            h.imaginary[m][kRings + ring] = d;
        }
    }
}

BiasTerms::Moments BiasTerms::moments(Vec2 place) const {
    Moments h;
    if (const Given* given = std::get_if<Given>(&images_)) {
        add_rings(*given->darkness, *given->residual, place, h);
    } else {
        const Fitted& fitted = std::get<Fitted>(images_);
        add_rings(*fitted.darkness, *fitted.transmission, place, h);
    }
    return h;
}

BiasTerms::Terms BiasTerms::of(Vec2 place) const {
    Terms terms;
    std::size_t next = 0;
    const auto add = [&](float x, float y) {
        terms.x[next] = x;
        terms.y[next] = y;
        ++next;
    };
    for (const Vec2 s : neighbours(place)) add(static_cast<float>(s.x), static_cast<float>(s.y));
    const Moments h = moments(place);
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

Vec2 BiasTerms::weighted(Vec2 place, const std::vector<float>& weights) const {
    const float* weight = weights.data();
    Vec2 sum{0, 0};
    for (const Vec2 s : neighbours(place)) sum += static_cast<double>(*weight++) * s;
    const Moments h = moments(place);
    float x = 0;
    float y = 0;
    for (std::size_t s = 0; s < kSources; ++s) {
        x += *weight * h.real[1][s];
        y += *weight++ * h.imaginary[1][s];
    }
    for (std::size_t m = 0; m + 1 < kOrders; ++m) {
        // Σ_p w_pq h_{m+1,p}, for each q
        std::array<float, kSources> real{};
        std::array<float, kSources> imaginary{};
        for (std::size_t p = 0; p < kSources; ++p) {
            const float a = h.real[m + 1][p];
            const float b = h.imaginary[m + 1][p];
#pragma omp simd
            for (std::size_t q = 0; q < kSources; ++q) {
                real[q] += weight[q] * a;
                imaginary[q] += weight[q] * b;
            }
            weight += kSources;
        }
#pragma omp simd reduction(+ : x, y)
        for (std::size_t q = 0; q < kSources; ++q) {
            x += real[q] * h.real[m][q] + imaginary[q] * h.imaginary[m][q];
            y += imaginary[q] * h.real[m][q] - real[q] * h.imaginary[m][q];
        }
    }
    return sum + Vec2{static_cast<double>(x), static_cast<double>(y)};
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
