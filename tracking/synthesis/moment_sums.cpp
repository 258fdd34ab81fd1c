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

/// Values of both images at all places of the rings, side by side: residual, darkness.
struct RingValues {
    alignas(64) std::array<float, 2 * MomentSums::kLanes * kAngles> value;

    HWY_INLINE float* at(std::size_t angle, std::size_t ring) {
        return &value[2 * (MomentSums::kLanes * angle + ring)];
    }
};

/// Places between pixels, in images of one size.
struct Between {
    alignas(64) std::array<int, MomentSums::kLanes> column, row;
    alignas(64) std::array<float, MomentSums::kLanes> right, below;  ///< shares of the next ones

    HWY_INLINE void set(std::size_t lane, const PixelRows& image, Vector x, Vector y) {
        const Whole zero = hn::Zero(kWhole);
        const Whole c =
            hn::Min(hn::Max(hn::ConvertTo(kWhole, x), zero), hn::Set(kWhole, image.width - 2));
        const Whole r =
            hn::Min(hn::Max(hn::ConvertTo(kWhole, y), zero), hn::Set(kWhole, image.height - 2));
        hn::Store(c, kWhole, &column[lane]);
        hn::Store(r, kWhole, &row[lane]);
        hn::Store(hn::Sub(x, hn::ConvertTo(kTag, c)), kTag, &right[lane]);
        hn::Store(hn::Sub(y, hn::ConvertTo(kTag, r)), kTag, &below[lane]);
    }

    /// Residual and darkness at a place.
    HWY_INLINE void read(std::size_t lane, const PixelRows& residual, const PixelRows& darkness,
                         float* values) const {
        const float* left = residual.first + row[lane] * residual.stride + column[lane];
        const float* dark = darkness.first + row[lane] * darkness.stride + column[lane];
#if HWY_TARGET == HWY_SCALAR
        values[0] = value(lane, left, residual.stride);
        values[1] = value(lane, dark, darkness.stride);
#else
        constexpr hn::Full128<float> kBoth;
        constexpr hn::Full64<float> kPair;
        const auto pairs = [&](const float* first, const float* second) HWY_ATTR {
            return hn::Combine(kBoth, hn::LoadU(kPair, second), hn::LoadU(kPair, first));
        };
        const auto upper = pairs(left, dark);
        const auto lower = pairs(left + residual.stride, dark + darkness.stride);
        const auto level = hn::MulAdd(hn::Set(kBoth, below[lane]), hn::Sub(lower, upper), upper);
        const auto first = hn::ConcatEven(kBoth, level, level);
        const auto second = hn::ConcatOdd(kBoth, level, level);
        const auto both = hn::MulAdd(hn::Set(kBoth, right[lane]), hn::Sub(second, first), first);
        hn::StoreU(hn::LowerHalf(kPair, both), kPair, values);
#endif
    }

#if HWY_TARGET == HWY_SCALAR
    float value(std::size_t lane, const float* at, std::ptrdiff_t stride) const {
        const float first = at[0] + below[lane] * (at[stride] - at[0]);
        const float second = at[1] + below[lane] * (at[stride + 1] - at[1]);
        return first + right[lane] * (second - first);
    }
#endif
};

/// Reading takes most of the time. Two pixels of both images are read at once, as vectors of
/// scattered places are slower.
HWY_INLINE void read_rings(const MomentPlaces& places, const MomentWaves& waves,
                           RingValues& values) {
    for (std::size_t k = 0; k < kAngles; ++k) {
        Between between;
        for (std::size_t lane = 0; lane < MomentSums::kLanes; lane += hn::Lanes(kTag)) {
            const Vector radius = hn::Mul(hn::Set(kTag, static_cast<float>(kAngles)),
                                          hn::Load(kTag, &places.radius[lane]));
            between.set(
                lane, places.darkness,
                hn::MulAdd(radius, hn::Set(kTag, waves.cosine[k][1]), hn::Set(kTag, places.x)),
                hn::MulAdd(radius, hn::Set(kTag, waves.sine[k][1]), hn::Set(kTag, places.y)));
        }
        for (std::size_t lane = 0; lane < MomentSums::kLanes; ++lane) {
            between.read(lane, places.residual, places.darkness, values.at(k, lane));
        }
    }
}

/// Σ f e^{imθ} of one image, from sums over four angles at right angles to one another: turning by
/// π/2 multiplies e^{imθ} by i^m.
struct Sums {
    Vector real[MomentSums::kOrders];
    Vector imaginary[MomentSums::kOrders];

    HWY_INLINE Sums() {
        for (std::size_t m = 0; m < MomentSums::kOrders; ++m) {
            real[m] = imaginary[m] = hn::Zero(kTag);
        }
    }

    HWY_INLINE void add(const Vector* f, const MomentWaves& waves, std::size_t k) {
        const auto cosine = [&](std::size_t m)
                                HWY_ATTR { return hn::Set(kTag, waves.cosine[k][m]); };
        const auto sine = [&](std::size_t m) HWY_ATTR { return hn::Set(kTag, waves.sine[k][m]); };
        const Vector all = hn::Add(hn::Add(f[0], f[2]), hn::Add(f[1], f[3]));
        const Vector across = hn::Sub(hn::Add(f[0], f[2]), hn::Add(f[1], f[3]));
        const Vector a = hn::Sub(f[0], f[2]);
        const Vector b = hn::Sub(f[1], f[3]);
        real[0] = hn::MulAdd(all, cosine(0), real[0]);
        // (a + ib) e^{iθ}
        real[1] = hn::MulAdd(a, cosine(1), hn::NegMulAdd(b, sine(1), real[1]));
        imaginary[1] = hn::MulAdd(a, sine(1), hn::MulAdd(b, cosine(1), imaginary[1]));
        real[2] = hn::MulAdd(across, cosine(2), real[2]);
        imaginary[2] = hn::MulAdd(across, sine(2), imaginary[2]);
        // (a − ib) e^{3iθ}
        real[3] = hn::MulAdd(a, cosine(3), hn::MulAdd(b, sine(3), real[3]));
        imaginary[3] = hn::MulAdd(a, sine(3), hn::NegMulAdd(b, cosine(3), imaginary[3]));
        real[4] = hn::MulAdd(all, cosine(4), real[4]);
        imaginary[4] = hn::MulAdd(all, sine(4), imaginary[4]);
    }

    HWY_INLINE void store(std::size_t at, MomentSums::Moments& h) const {
        for (std::size_t m = 0; m < MomentSums::kOrders; ++m) {
            hn::StoreU(real[m], kTag, &h.real[m][at]);
            hn::StoreU(imaginary[m], kTag, &h.imaginary[m][at]);
        }
    }
};

void moments_about(const MomentPlaces& places, const MomentWaves& waves, MomentSums::Moments& h) {
    static_assert(MomentSums::kOrders == 5 && kAngles % 4 == 0);
    RingValues values;
    read_rings(places, waves, values);
    for (std::size_t lane = 0; lane < MomentSums::kLanes; lane += hn::Lanes(kTag)) {
        Sums residual;
        Sums darkness;
        for (std::size_t k = 0; k < kAngles / 4; ++k) {
            Vector left[4];
            Vector dark[4];
            for (std::size_t quarter = 0; quarter < 4; ++quarter) {
                const float* pair = values.at(k + quarter * (kAngles / 4), lane);
                hn::LoadInterleaved2(kTag, pair, left[quarter], dark[quarter]);
                if (places.is_transmission) {
                    left[quarter] =
                        hn::Add(left[quarter], hn::Sub(dark[quarter], hn::Set(kTag, 1.0F)));
                }
            }
            residual.add(left, waves, k);
            darkness.add(dark, waves, k);
        }
        residual.store(lane, h);
        darkness.store(MomentSums::kLanes + lane, h);
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
