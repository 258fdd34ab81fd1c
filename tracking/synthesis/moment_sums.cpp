#include "tracking/synthesis/moment_sums.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tracking/synthesis/moment_sums.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef GRAINFIELD_MOMENT_WAVES
#define GRAINFIELD_MOMENT_WAVES
namespace grainfield::tracking {

inline constexpr std::size_t kAngles = 24;

/// cos mθ and sin mθ over the number of angles, by angle.
struct MomentWaves {
    std::array<std::array<float, MomentSums::kOrders>, kAngles> cosine, sine;
};

/// What `moments` reads.
struct MomentPlaces {
    PixelRows darkness, residual;
    bool is_transmission;
    alignas(32) std::array<float, MomentSums::kLanes> radius;
    float x, y;
};

}  // namespace grainfield::tracking
#endif

HWY_BEFORE_NAMESPACE();
namespace grainfield::tracking::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, MomentSums::kLanes>;
using Vector = hn::Vec<Tag>;
constexpr Tag kTag;
constexpr hn::RebindToSigned<Tag> kWhole;
using Whole = hn::Vec<hn::RebindToSigned<Tag>>;

/// Places between pixels, in images of one size.
struct Between {
    Whole column, row;
    Vector right, below;  ///< shares of the next column and row

    HWY_INLINE Between(const PixelRows& image, Vector x, Vector y) {
        const Whole zero = hn::Zero(kWhole);
        column = hn::Min(hn::Max(hn::ConvertTo(kWhole, x), zero), hn::Set(kWhole, image.width - 2));
        row = hn::Min(hn::Max(hn::ConvertTo(kWhole, y), zero), hn::Set(kWhole, image.height - 2));
        right = hn::Sub(x, hn::ConvertTo(kTag, column));
        below = hn::Sub(y, hn::ConvertTo(kTag, row));
    }

    HWY_INLINE Vector of(const PixelRows& image) const {
        const Whole at =
            hn::Add(hn::Mul(row, hn::Set(kWhole, static_cast<int>(image.stride))), column);
        const float* next = image.first + image.stride;
        const Vector a = hn::GatherIndex(kTag, image.first, at);
        const Vector b = hn::GatherIndex(kTag, image.first + 1, at);
        const Vector c = hn::GatherIndex(kTag, next, at);
        const Vector d = hn::GatherIndex(kTag, next + 1, at);
        const Vector upper = hn::MulAdd(right, hn::Sub(b, a), a);
        const Vector lower = hn::MulAdd(right, hn::Sub(d, c), c);
        return hn::MulAdd(below, hn::Sub(lower, upper), upper);
    }
};

void moments_about(const MomentPlaces& places, const MomentWaves& waves, MomentSums::Moments& h) {
    constexpr std::size_t kOrders = MomentSums::kOrders;
    for (std::size_t lane = 0; lane < MomentSums::kLanes; lane += hn::Lanes(kTag)) {
        const Vector radius = hn::Mul(hn::Set(kTag, static_cast<float>(kAngles)),
                                      hn::Load(kTag, &places.radius[lane]));
        Vector real[2][kOrders];
        Vector imaginary[2][kOrders];
        for (int image = 0; image < 2; ++image) {
            for (std::size_t m = 0; m < kOrders; ++m) {
                real[image][m] = hn::Zero(kTag);
                imaginary[image][m] = hn::Zero(kTag);
            }
        }
        for (std::size_t k = 0; k < kAngles; ++k) {
            const Vector x =
                hn::MulAdd(radius, hn::Set(kTag, waves.cosine[k][1]), hn::Set(kTag, places.x));
            const Vector y =
                hn::MulAdd(radius, hn::Set(kTag, waves.sine[k][1]), hn::Set(kTag, places.y));
            const Between between(places.darkness, x, y);
            const Vector darkness = between.of(places.darkness);
            Vector residual = between.of(places.residual);
            if (places.is_transmission) {
                residual = hn::Add(residual, hn::Sub(darkness, hn::Set(kTag, 1.0F)));
            }
            for (std::size_t m = 0; m < kOrders; ++m) {
                const Vector cosine = hn::Set(kTag, waves.cosine[k][m]);
                real[0][m] = hn::MulAdd(residual, cosine, real[0][m]);
                real[1][m] = hn::MulAdd(darkness, cosine, real[1][m]);
                const Vector sine = hn::Set(kTag, waves.sine[k][m]);
                imaginary[0][m] = hn::MulAdd(residual, sine, imaginary[0][m]);
                imaginary[1][m] = hn::MulAdd(darkness, sine, imaginary[1][m]);
            }
        }
        for (std::size_t image = 0; image < 2; ++image) {
            const std::size_t at = image * MomentSums::kLanes + lane;
            for (std::size_t m = 0; m < kOrders; ++m) {
                hn::StoreU(real[image][m], kTag, &h.real[m][at]);
                hn::StoreU(imaginary[image][m], kTag, &h.imaginary[m][at]);
            }
        }
    }
}

MomentSums::Sum weighted_sum(const MomentSums::Moments& h, const MomentSums::Weights& weights) {
    Vector x = hn::Zero(kTag);
    Vector y = hn::Zero(kTag);
    for (std::size_t q = 0; q < MomentSums::kSources; q += hn::Lanes(kTag)) {
        const Vector first = hn::Load(kTag, &weights.first[q]);
        x = hn::MulAdd(first, hn::Load(kTag, &h.real[1][q]), x);
        y = hn::MulAdd(first, hn::Load(kTag, &h.imaginary[1][q]), y);
        for (std::size_t m = 0; m + 1 < MomentSums::kOrders; ++m) {
            // Σ_p w_pq h_{m+1,p}
            Vector real = hn::Zero(kTag);
            Vector imaginary = hn::Zero(kTag);
            for (std::size_t p = 0; p < MomentSums::kSources; ++p) {
                const Vector weight = hn::Load(kTag, &weights.product[m][p][q]);
                real = hn::MulAdd(weight, hn::Set(kTag, h.real[m + 1][p]), real);
                imaginary = hn::MulAdd(weight, hn::Set(kTag, h.imaginary[m + 1][p]), imaginary);
            }
            const Vector a = hn::Load(kTag, &h.real[m][q]);
            const Vector b = hn::Load(kTag, &h.imaginary[m][q]);
            x = hn::MulAdd(real, a, hn::MulAdd(imaginary, b, x));
            y = hn::MulAdd(imaginary, a, hn::NegMulAdd(real, b, y));
        }
    }
    return {hn::GetLane(hn::SumOfLanes(kTag, x)), hn::GetLane(hn::SumOfLanes(kTag, y))};
}

}  // namespace grainfield::tracking::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainfield::tracking {

HWY_EXPORT(moments_about);
HWY_EXPORT(weighted_sum);

namespace {

const MomentWaves& waves() {
    static const MomentWaves kept = [] {
        MomentWaves made;
        for (std::size_t k = 0; k < kAngles; ++k) {
            for (std::size_t m = 0; m < MomentSums::kOrders; ++m) {
                const double phase =
                    2 * std::numbers::pi * static_cast<double>(m * k) / double{kAngles};
                made.cosine[k][m] = static_cast<float>(std::cos(phase) / kAngles);
                made.sine[k][m] = static_cast<float>(std::sin(phase) / kAngles);
            }
        }
        return made;
    }();
    return kept;
}

}  // namespace

MomentSums::Moments MomentSums::moments(const PixelRows& darkness, const PixelRows& residual,
                                        bool is_transmission,
                                        const std::array<float, kRings>& radii, float x, float y) {
    MomentPlaces places{darkness, residual, is_transmission, {}, x, y};
    std::copy(radii.begin(), radii.end(), places.radius.begin());
    Moments h;
    HWY_DYNAMIC_DISPATCH(moments_about)(places, waves(), h);
    return h;
}

MomentSums::Sum MomentSums::weighted(const Moments& h, const Weights& weights) {
    return HWY_DYNAMIC_DISPATCH(weighted_sum)(h, weights);
}

}  // namespace grainfield::tracking
#endif
