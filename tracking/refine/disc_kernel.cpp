#include "tracking/refine/disc_kernel.h"

#include <algorithm>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tracking/refine/disc_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "tracking/refine/disc_profile-inl.h"

#ifndef GRAINFIELD_DISC_ROWS
#define GRAINFIELD_DISC_ROWS
namespace grainfield::tracking {

/// The part of a row that two windows share.
struct SharedRow {
    const float *ax, *ay, *bx, *by;
    int count;
};

struct DiscRow {
    float dx;  ///< of the first pixel to the centre
    float dy;
    int count;
    const float* darkness;
    float* transmission;
    float* jx;
    float* jy;
};

}  // namespace grainfield::tracking
#endif

HWY_BEFORE_NAMESPACE();
namespace grainfield::tracking::HWY_NAMESPACE {

/// Calls body(dx, i) for the vectors of a row.
template <class Body>
HWY_INLINE void for_each_vector(const DiscRow& row, Body&& body) {
    const int lanes = static_cast<int>(hn::Lanes(kTag));
    Vector dx = hn::Add(hn::Iota(kTag, 0.0F), hn::Set(kTag, row.dx));
    const Vector next = hn::Set(kTag, static_cast<float>(lanes));
    for (int i = 0; i < row.count; i += lanes) {
        body(dx, i);
        dx = hn::Add(dx, next);
    }
}

void place_rows(const DiscTerms& disc, const DiscRow* rows, int n) {
    for (int j = 0; j < n; ++j) {
        const DiscRow& row = rows[j];
        const Vector dy2 = hn::Set(kTag, row.dy * row.dy);
        for_each_vector(row, [&](Vector dx, int i) HWY_ATTR {
            const Vector old = hn::LoadU(kTag, row.transmission + i);
            hn::StoreU(hn::Mul(old, profile(dx, dy2, disc).t), kTag, row.transmission + i);
        });
    }
}

double explained_rows(const DiscTerms& disc, const DiscRow* rows, int n) {
    Vector gain = hn::Zero(kTag);
    for (int j = 0; j < n; ++j) {
        const DiscRow& row = rows[j];
        const Vector dy2 = hn::Set(kTag, row.dy * row.dy);
        for_each_vector(row, [&](Vector dx, int i) HWY_ATTR {
            const Vector old = hn::LoadU(kTag, row.transmission + i);
            const Vector lifted = hn::Mul(old, reciprocal(profile(dx, dy2, disc).t));
            const Vector b = residual_of(hn::LoadU(kTag, row.darkness + i), old);
            const Vector step = hn::Sub(lifted, old);
            gain = hn::MulAdd(step, hn::MulAdd(hn::Set(kTag, 2.0F), b, step), gain);
        });
    }
    return sum(gain);
}

double misfit_rows(const DiscRow* rows, int n) {
    Vector misfit = hn::Zero(kTag);
    for (int j = 0; j < n; ++j) {
        const DiscRow& row = rows[j];
        const Vector end = hn::Set(kTag, row.dx + static_cast<float>(row.count) - 0.5F);
        for_each_vector(row, [&](Vector dx, int i) HWY_ATTR {
            const Vector all = residual_of(hn::LoadU(kTag, row.darkness + i),
                                           hn::LoadU(kTag, row.transmission + i));
            const Vector r = hn::IfThenElseZero(hn::Lt(dx, end), all);
            misfit = hn::MulAdd(r, r, misfit);
        });
    }
    return sum(misfit);
}

void gradient_rows(const DiscTerms& disc, const DiscRow* rows, int n) {
    for (int j = 0; j < n; ++j) {
        const DiscRow& row = rows[j];
        const Vector dy = hn::Set(kTag, row.dy);
        const Vector dy2 = hn::Mul(dy, dy);
        for_each_vector(row, [&](Vector dx, int i) HWY_ATTR {
            const Profile q = profile(dx, dy2, disc);
            const Vector g = hn::Mul(
                hn::Mul(hn::LoadU(kTag, row.transmission + i), hn::Set(kTag, disc.two_over_width)),
                hn::Mul(q.p, q.r_inv));
            hn::StoreU(hn::Mul(g, dx), kTag, row.jx + i);
            hn::StoreU(hn::Mul(g, dy), kTag, row.jy + i);
        });
    }
}

/// Beyond the chord of either window J is zero or was never asked for: the tail is masked.
void cross_rows(const SharedRow* rows, int n, double* sums) {
    const int lanes = static_cast<int>(hn::Lanes(kTag));
    Vector xx = hn::Zero(kTag);
    Vector xy = xx;
    Vector yx = xx;
    Vector yy = xx;
    for (int j = 0; j < n; ++j) {
        const SharedRow& row = rows[j];
        for (int i = 0; i < row.count; i += lanes) {
            const auto inside = hn::FirstN(kTag, static_cast<std::size_t>(row.count - i));
            const Vector ax = hn::IfThenElseZero(inside, hn::LoadU(kTag, row.ax + i));
            const Vector ay = hn::IfThenElseZero(inside, hn::LoadU(kTag, row.ay + i));
            const Vector bx = hn::LoadU(kTag, row.bx + i);
            const Vector by = hn::LoadU(kTag, row.by + i);
            xx = hn::MulAdd(ax, bx, xx);
            xy = hn::MulAdd(ax, by, xy);
            yx = hn::MulAdd(ay, bx, yx);
            yy = hn::MulAdd(ay, by, yy);
        }
    }
    sums[0] = sum(xx);
    sums[1] = sum(xy);
    sums[2] = sum(yx);
    sums[3] = sum(yy);
}

}  // namespace grainfield::tracking::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainfield::tracking {

HWY_EXPORT(place_rows);
HWY_EXPORT(explained_rows);
HWY_EXPORT(misfit_rows);
HWY_EXPORT(gradient_rows);
HWY_EXPORT(cross_rows);

namespace {

/// The rows of a window as the kernels want them. Const images are only read.
const std::vector<DiscRow>& rows_of(const DiscWindow& window, Vec2 centre,
                                    const PaddedImage* darkness, const PaddedImage& transmission,
                                    float* jx, float* jy) {
    thread_local std::vector<DiscRow> rows;
    rows.clear();
    for (int j = 0; j < window.rows; ++j) {
        const auto row = static_cast<std::size_t>(j);
        const int y = window.first_row + j;
        const int x = window.first[row];
        const std::size_t at = row * static_cast<std::size_t>(window.stride);
        rows.push_back({static_cast<float>(x - centre.x), static_cast<float>(y - centre.y),
                        window.count[row], darkness == nullptr ? nullptr : darkness->row(y) + x,
                        const_cast<float*>(transmission.row(y)) + x,
                        jx == nullptr ? nullptr : jx + at, jy == nullptr ? nullptr : jy + at});
    }
    return rows;
}

DiscWindow& scratch_window() {
    thread_local DiscWindow window;
    return window;
}

}  // namespace

double longest_step(const DiscProfile& disc) {
    return std::max(0.5, 0.15 * disc.diameter);
}

int scene_margin(const DiscProfile& disc) {
    return static_cast<int>(std::ceil(disc.reach() + std::max(1.0, longest_step(disc)))) + 3;
}

PaddedImage padded_darkness(const Image& darkness, const DiscProfile& disc) {
    return {darkness, scene_margin(disc), 1.0F};
}

PaddedImage clear_transmission(int width, int height, const DiscProfile& disc) {
    return {width, height, scene_margin(disc), 1.0F, 0.0F};
}

void DiscWindow::enclose(const PaddedImage& image, Vec2 centre, double half) {
    rows = 0;
    // Written so that a NaN encloses nothing.
    if (!(centre.x > -half && centre.x < image.width() - 1 + half && centre.y > -half &&
          centre.y < image.height() - 1 + half)) {
        return;
    }
    first_row = std::max(0, static_cast<int>(std::ceil(centre.y - half)));
    const int last_row =
        std::min(image.height() - 1, static_cast<int>(std::floor(centre.y + half)));
    rows = std::max(0, last_row - first_row + 1);
    first.resize(static_cast<std::size_t>(rows));
    count.resize(static_cast<std::size_t>(rows));
    const int leftmost = -image.margin();
    const int rightmost = image.width() - 1 + image.margin();
    const auto half2 = static_cast<float>(half * half);
    const auto x = static_cast<float>(centre.x - leftmost);
    for (int j = 0; j < rows; ++j) {
        const auto dy = static_cast<float>(first_row + j - centre.y);
        const float chord = std::sqrt(std::max(0.0F, half2 - dy * dy));
        // Both ends are positive from here, so that truncation rounds down.
        const int left =
            std::max(leftmost + static_cast<int>(std::max(0.0F, x - chord) + 1.0F), leftmost);
        const int right =
            std::min(leftmost + static_cast<int>(std::max(0.0F, x + chord)), rightmost);
        first[static_cast<std::size_t>(j)] = left;
        count[static_cast<std::size_t>(j)] = std::max(0, right - left + 1);
    }
    const int widest = 2 * static_cast<int>(half) + 2;
    stride = (widest + PaddedImage::kMostLanes) / PaddedImage::kMostLanes * PaddedImage::kMostLanes;
}

void place_disc(PaddedImage& transmission, Vec2 centre, const DiscProfile& disc) {
    DiscWindow& window = scratch_window();
    window.enclose(transmission, centre, disc.reach());
    const auto& rows = rows_of(window, centre, nullptr, transmission, nullptr, nullptr);
    HWY_DYNAMIC_DISPATCH(place_rows)
    (terms_of(disc), rows.data(), static_cast<int>(rows.size()));
}

double explained_misfit(const PaddedImage& darkness, const PaddedImage& transmission, Vec2 centre,
                        const DiscProfile& disc) {
    DiscWindow& window = scratch_window();
    window.enclose(transmission, centre, disc.reach());
    const auto& rows = rows_of(window, centre, &darkness, transmission, nullptr, nullptr);
    return HWY_DYNAMIC_DISPATCH(explained_rows)(terms_of(disc), rows.data(),
                                                static_cast<int>(rows.size()));
}

double local_residual(const PaddedImage& darkness, const PaddedImage& transmission, Vec2 centre,
                      const DiscProfile& disc) {
    DiscWindow& window = scratch_window();
    window.enclose(transmission, centre, disc.reach());
    int pixels = 0;
    for (std::size_t j = 0; j < static_cast<std::size_t>(window.rows); ++j) {
        const int left = std::max(window.first[j], 0);
        const int right = std::min(window.first[j] + window.count[j], transmission.width());
        pixels += std::max(0, right - left);
    }
    if (pixels == 0) return std::numeric_limits<double>::quiet_NaN();
    const auto& rows = rows_of(window, centre, &darkness, transmission, nullptr, nullptr);
    return std::sqrt(HWY_DYNAMIC_DISPATCH(misfit_rows)(rows.data(), static_cast<int>(rows.size())) /
                     pixels);
}

void gradient(const PaddedImage& transmission, Vec2 centre, const DiscProfile& disc,
              DiscWindow& window, DiscGradient& out) {
    window.enclose(transmission, centre, disc.reach());
    // Room for a whole vector behind the last row.
    const auto floats =
        static_cast<std::size_t>(window.rows) * static_cast<std::size_t>(window.stride) +
        PaddedImage::kMostLanes;
    if (out.x.size() < floats) out.x.resize(floats);
    if (out.y.size() < floats) out.y.resize(floats);
    const auto& rows = rows_of(window, centre, nullptr, transmission, out.x.data(), out.y.data());
    HWY_DYNAMIC_DISPATCH(gradient_rows)
    (terms_of(disc), rows.data(), static_cast<int>(rows.size()));
}

CrossBlock cross_block(const DiscWindow& a, const DiscGradient& gradient_a, const DiscWindow& b,
                       const DiscGradient& gradient_b) {
    thread_local std::vector<SharedRow> rows;
    rows.clear();
    const int first = std::max(a.first_row, b.first_row);
    const int end = std::min(a.first_row + a.rows, b.first_row + b.rows);
    for (int y = first; y < end; ++y) {
        const auto i = static_cast<std::size_t>(y - a.first_row);
        const auto j = static_cast<std::size_t>(y - b.first_row);
        const int left = std::max(a.first[i], b.first[j]);
        const int right = std::min(a.first[i] + a.count[i], b.first[j] + b.count[j]);
        if (right <= left) continue;
        const std::size_t at =
            i * static_cast<std::size_t>(a.stride) + static_cast<std::size_t>(left - a.first[i]);
        const std::size_t bt =
            j * static_cast<std::size_t>(b.stride) + static_cast<std::size_t>(left - b.first[j]);
        rows.push_back({gradient_a.x.data() + at, gradient_a.y.data() + at,
                        gradient_b.x.data() + bt, gradient_b.y.data() + bt, right - left});
    }
    double sums[4] = {};
    HWY_DYNAMIC_DISPATCH(cross_rows)(rows.data(), static_cast<int>(rows.size()), sums);
    return {sums[0], sums[1], sums[2], sums[3]};
}

}  // namespace grainfield::tracking
#endif
