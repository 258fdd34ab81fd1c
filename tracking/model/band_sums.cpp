#include "tracking/model/band_sums.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tracking/model/band_sums.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "tracking/model/kernel_profile-inl.h"

#ifndef GRAINFIELD_BAND_ROW
#define GRAINFIELD_BAND_ROW
namespace grainfield::tracking {

/// The pixels of one row that a disc reaches.
struct BandRow {
    float dx;  ///< of the first pixel to the centre
    float dy;
    int count;
    float* transmission;
    float* along_x;
    float* along_y;
    float* squares;
};

}  // namespace grainfield::tracking
#endif

HWY_BEFORE_NAMESPACE();
namespace grainfield::tracking::HWY_NAMESPACE {

template <class Profile>
HWY_INLINE void add_row(const Profile& disc, const BandRow& row) {
    const int lanes = static_cast<int>(hn::Lanes(kTag));
    const Vector one = hn::Set(kTag, 1.0F);
    const Vector dy = hn::Set(kTag, row.dy);
    const Vector dy2 = hn::Set(kTag, row.dy * row.dy);
    Vector dx = hn::Add(hn::Iota(kTag, 0.0F), hn::Set(kTag, row.dx));
    for (int i = 0; i < row.count; i += lanes) {
        const Vector t = disc.transmission(dx, dy2);
        const Vector p = hn::Sub(one, t);
        // The direction n: one step of Newton makes |n| = 1 to single precision.
        const Vector r2 = hn::Max(hn::MulAdd(dx, dx, dy2), hn::Set(kTag, 1e-6F));
        const Vector estimate = hn::ApproximateReciprocalSqrt(r2);
        const Vector half = hn::Mul(hn::Mul(r2, estimate), hn::Set(kTag, 0.5F));
        const Vector share =
            hn::Mul(p, hn::Mul(estimate, hn::NegMulAdd(half, estimate, hn::Set(kTag, 1.5F))));
        const auto add = [&](float* to, Vector a, Vector b) HWY_ATTR {
            hn::StoreU(hn::MulAdd(a, b, hn::LoadU(kTag, to + i)), kTag, to + i);
        };
        hn::StoreU(hn::Mul(hn::LoadU(kTag, row.transmission + i), t), kTag, row.transmission + i);
        add(row.along_x, share, dx);
        add(row.along_y, share, dy);
        add(row.squares, p, p);
        dx = hn::Add(dx, hn::Set(kTag, static_cast<float>(lanes)));
    }
}

void add_rows(const DiscTerms& terms, const BandRow* rows, int n) {
    with_profile(terms, [&](const auto& disc) HWY_ATTR {
        for (int j = 0; j < n; ++j) add_row(disc, rows[j]);
    });
}

}  // namespace grainfield::tracking::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainfield::tracking {

HWY_EXPORT(add_rows);

void BandSums::assign(int width, int first, int last, const std::vector<Vec2>& discs,
                      const KernelProfile& profile) {
    const DiscTerms terms = profile.terms();
    const double reach = static_cast<double>(terms.reach);
    width_ = width;
    first_ = first;
    // Discs and vectors may run beyond both ends of a row.
    margin_ = 2 * static_cast<std::size_t>(std::ceil(reach)) + PaddedImage::kMostLanes;
    stride_ = static_cast<std::size_t>(width) + 2 * margin_;
    const auto rows = static_cast<std::size_t>(last - first);
    values_.assign(rows * kPlanes * stride_, 0.0F);
    for (std::size_t row = 0; row < rows; ++row) {
        std::fill_n(values_.begin() + static_cast<std::ptrdiff_t>(row * kPlanes * stride_), stride_,
                    1.0F);
    }
    std::vector<BandRow> reached;
    for (const Vec2 p : discs) {
        // Written so that a NaN reaches nothing.
        if (!(p.x > -reach && p.x < width - 1 + reach)) continue;
        reached.clear();
        const int low = std::max(first, static_cast<int>(std::ceil(p.y - reach)));
        const int high = std::min(last - 1, static_cast<int>(std::floor(p.y + reach)));
        for (int y = low; y <= high; ++y) {
            const double dy = y - p.y;
            const double chord = std::sqrt(std::max(0.0, reach * reach - dy * dy));
            const int left = static_cast<int>(std::ceil(p.x - chord));
            const int right = static_cast<int>(std::floor(p.x + chord));
            const auto at = [&](int plane) {
                return values_.data() + static_cast<std::ptrdiff_t>(offset(plane, y)) + left;
            };
            reached.push_back({static_cast<float>(left - p.x), static_cast<float>(dy),
                               right - left + 1, at(0), at(1), at(2), at(3)});
        }
        HWY_DYNAMIC_DISPATCH(add_rows)
        (terms, reached.data(), static_cast<int>(reached.size()));
    }
}

}  // namespace grainfield::tracking
#endif
