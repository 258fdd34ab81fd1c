#include "tracking/synthesis/bias_terms.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace grainfield::tracking {
namespace {

constexpr std::array<double, BiasTerms::kRings> kRadius = {0.15, 0.3, 0.45, 0.6, 0.75, 0.9, 1.1};
constexpr std::array<double, BiasTerms::kDistances> kDistance = {
    0.35, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.45, 1.7, 2.0};  // [a]
constexpr double kFarthest = 2.3;                                    // [a] where the last φ is 0
constexpr double kItself = 0.1;                                      // [a]

/// Where the first φ begins [a].
constexpr double kFirst = 2 * kDistance[0] - kDistance[1];

/// Number of knots up to a distance, from a table.
class Knots {
 public:
    constexpr Knots() : below_{} {
        for (std::size_t i = 0; i < below_.size(); ++i) {
            const double d = static_cast<double>(i) / kSteps;
            below_[i] = static_cast<std::uint8_t>(
                std::upper_bound(kDistance.begin(), kDistance.end(), d) - kDistance.begin());
        }
    }
    /// d < kFarthest.
    constexpr std::size_t up_to(double d) const {
        std::size_t n = below_[static_cast<std::size_t>(d * kSteps)];
        while (n < kDistance.size() && kDistance[n] <= d) ++n;
        return n;
    }

 private:
    static constexpr double kSteps = 20;  // [1/a]
    std::array<std::uint8_t, static_cast<std::size_t>(kFarthest* kSteps) + 1> below_;
};
constexpr Knots kKnots;

/// Number of a source among those of MomentSums.
std::size_t lane_of(std::size_t source) {
    return source < std::size_t{BiasTerms::kRings}
               ? source
               : source - std::size_t{BiasTerms::kRings} + MomentSums::kLanes;
}

}  // namespace

BiasTerms::BiasTerms(const Image& darkness, const Image& residual, const std::vector<Vec2>& discs,
                     double diameter)
    : darkness_(PixelRows::of(darkness)),
      residual_(PixelRows::of(residual)),
      is_transmission_(false),
      diameter_(diameter) {
    if (!discs.empty()) grid_.emplace(discs, kFarthest * diameter);
}

BiasTerms::BiasTerms(const PaddedImage& darkness, const PaddedImage& transmission,
                     const std::vector<Vec2>& discs, double diameter)
    : darkness_(PixelRows::of(darkness)),
      residual_(PixelRows::of(transmission)),
      is_transmission_(true),
      diameter_(diameter) {
    if (!discs.empty()) grid_.emplace(discs, kFarthest * diameter);
}

std::array<Vec2, BiasTerms::kDistances> BiasTerms::neighbours(Vec2 place) const {
    std::array<Vec2, kDistances> sum{};
    const auto add_neighbour = [&](std::uint32_t, Vec2 disc) {
        const Vec2 apart = (1 / diameter_) * (disc - place);
        const double d = std::sqrt(squared_norm(apart));
        if (d < kItself) return;
        const Vec2 direction = (1 / d) * apart;
        // φ_k rises from the distance before its own, and falls to the one behind it.
        const auto next = static_cast<std::size_t>(
            std::upper_bound(kDistance.begin(), kDistance.end(), d) - kDistance.begin());
        const double before = next > 0 ? kDistance[next - 1] : kFirst;
        const double after = next < kDistance.size() ? kDistance[next] : kFarthest;
        if (next == 0 && d <= before) return;
        if (next < kDistance.size()) sum[next] += (d - before) / (after - before) * direction;
        if (next > 0) sum[next - 1] += (after - d) / (after - before) * direction;
    };
    if (grid_) grid_->near(place, kFarthest * diameter_, add_neighbour);
    return sum;
}

MomentSums::Moments BiasTerms::moments(Vec2 place) const {
    std::array<float, kRings> radii;
    for (std::size_t ring = 0; ring < kRings; ++ring) {
        radii[ring] = static_cast<float>(kRadius[ring] * diameter_);
    }
    return MomentSums::moments(darkness_, residual_, is_transmission_, radii,
                               static_cast<float>(place.x), static_cast<float>(place.y));
}

BiasTerms::Weights::Weights(const std::vector<double>& weights) {
    const double* next = weights.data();
    double before = 0;
    double begin = kFirst;
    for (std::size_t k = 0; k < pieces_.size(); ++k) {
        const double after = k < kDistance.size() ? *next++ : 0;
        const double end = k < kDistance.size() ? kDistance[k] : kFarthest;
        pieces_[k] = {begin, before, (after - before) / (end - begin)};
        before = after;
        begin = end;
    }
    const auto single = [&] { return static_cast<float>(*next++); };
    for (std::size_t s = 0; s < kSources; ++s) moments_.first[lane_of(s)] = single();
    for (auto& of_order : moments_.product) {
        for (std::size_t p = 0; p < kSources; ++p) {
            for (std::size_t q = 0; q < kSources; ++q) {
                of_order[lane_of(p)][lane_of(q)] = single();
            }
        }
    }
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
    const MomentSums::Moments h = moments(place);
    for (std::size_t s = 0; s < kSources; ++s) {
        add(h.real[1][lane_of(s)], h.imaginary[1][lane_of(s)]);
    }
    for (std::size_t m = 0; m + 1 < kOrders; ++m) {
        for (std::size_t p = 0; p < kSources; ++p) {
            const float a = h.real[m + 1][lane_of(p)];
            const float b = h.imaginary[m + 1][lane_of(p)];
            for (std::size_t q = 0; q < kSources; ++q) {
                const float c = h.real[m][lane_of(q)];
                const float d = h.imaginary[m][lane_of(q)];
                add(a * c + b * d, b * c - a * d);
            }
        }
    }
    return terms;
}

BiasTerms::Sum BiasTerms::weighted(Vec2 place, const Weights& weights) const {
    Sum sum{{0, 0}, kFarthest};
    const double scale = 1 / diameter_;
    if (grid_) {
        grid_->near(place, kFarthest * diameter_, [&](std::uint32_t, Vec2 disc) {
            const Vec2 apart = scale * (disc - place);
            const double d = std::sqrt(squared_norm(apart));
            if (d < kItself || d >= kFarthest) return;
            sum.nearest = std::min(sum.nearest, d);
            if (d <= kFirst) return;
            const Weights::Piece& piece = weights.pieces_[kKnots.up_to(d)];
            sum.value += ((piece.value + piece.slope * (d - piece.begin)) / d) * apart;
        });
    }
    const MomentSums::Sum pictured = MomentSums::weighted(moments(place), weights.moments_);
    sum.value += Vec2{static_cast<double>(pictured.x), static_cast<double>(pictured.y)};
    return sum;
}

double BiasTerms::nearest(Vec2 place) const {
    if (!grid_) return kFarthest;
    const double itself = kItself * kItself * diameter_ * diameter_;
    double least = kFarthest * kFarthest * diameter_ * diameter_;
    grid_->near(place, kFarthest * diameter_, [&](std::uint32_t, Vec2 disc) {
        const double d = squared_norm(disc - place);
        if (d >= itself) least = std::min(least, d);
    });
    return std::sqrt(least) / diameter_;
}

}  // namespace grainfield::tracking
