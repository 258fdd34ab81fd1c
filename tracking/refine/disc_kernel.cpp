#include "tracking/refine/disc_kernel.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tracking/refine/disc_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "tracking/model/kernel_profile-inl.h"

#ifndef GRAINFIELD_DISC_ROWS
#define GRAINFIELD_DISC_ROWS
namespace grainfield::tracking {

struct DiscRow {
    float dx;  ///< of the first pixel to the centre
    float dy;
    int count;
    const float* darkness;
    const float* transmission;
    float* drawn;  ///< the same pixels of T, where they are written
};

}  // namespace grainfield::tracking
#endif

HWY_BEFORE_NAMESPACE();
namespace grainfield::tracking::HWY_NAMESPACE {

/// Calls body(dx, i) for the vectors of a row.
template <class Body>
HWY_INLINE void for_each_in_row(const DiscRow& row, Body&& body) {
    const int lanes = static_cast<int>(hn::Lanes(kTag));
    Vector dx = hn::Add(hn::Iota(kTag, 0.0F), hn::Set(kTag, row.dx));
    const Vector next = hn::Set(kTag, static_cast<float>(lanes));
    for (int i = 0; i < row.count; i += lanes) {
        body(dx, i);
        dx = hn::Add(dx, next);
    }
}

template <class Profile>
HWY_INLINE void place_on(const Profile& disc, const DiscRow* rows, int n) {
    for (int j = 0; j < n; ++j) {
        const DiscRow& row = rows[j];
        const Vector dy2 = hn::Set(kTag, row.dy * row.dy);
        for_each_in_row(row, [&](Vector dx, int i) HWY_ATTR {
            const Vector old = hn::LoadU(kTag, row.drawn + i);
            hn::StoreU(hn::Mul(old, disc.transmission(dx, dy2)), kTag, row.drawn + i);
        });
    }
}

void place_rows(const DiscTerms& terms, const DiscRow* rows, int n) {
    with_profile(terms, [&](const auto& disc) HWY_ATTR { place_on(disc, rows, n); });
}

template <class Profile>
HWY_INLINE double explained_on(const Profile& disc, const DiscRow* rows, int n) {
    Vector gain = hn::Zero(kTag);
    for (int j = 0; j < n; ++j) {
        const DiscRow& row = rows[j];
        const Vector dy2 = hn::Set(kTag, row.dy * row.dy);
        for_each_in_row(row, [&](Vector dx, int i) HWY_ATTR {
            const Vector old = hn::LoadU(kTag, row.transmission + i);
            const Vector lifted = hn::Mul(old, reciprocal(disc.transmission(dx, dy2)));
            const Vector b = residual_of(hn::LoadU(kTag, row.darkness + i), old);
            const Vector step = hn::Sub(lifted, old);
            gain = hn::MulAdd(step, hn::MulAdd(hn::Set(kTag, 2.0F), b, step), gain);
        });
    }
    return sum(gain);
}

double explained_rows(const DiscTerms& terms, const DiscRow* rows, int n) {
    return with_profile(terms,
                        [&](const auto& disc) HWY_ATTR { return explained_on(disc, rows, n); });
}

}  // namespace grainfield::tracking::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainfield::tracking {

HWY_EXPORT(place_rows);
HWY_EXPORT(explained_rows);

namespace {

/// The rows of a window as the kernels want them; `drawn`: the same image if it is written, else
/// null.
const std::vector<DiscRow>& rows_of(const DiscWindow& window, Vec2 centre,
                                    const PaddedImage* darkness, const PaddedImage& transmission,
                                    PaddedImage* drawn) {
    thread_local std::vector<DiscRow> rows;
    rows.clear();
    for (int j = 0; j < window.rows; ++j) {
        const auto row = static_cast<std::size_t>(j);
        const int y = window.first_row + j;
        const int x = window.first[row];
        rows.push_back({static_cast<float>(x - centre.x), static_cast<float>(y - centre.y),
                        window.count[row], darkness == nullptr ? nullptr : darkness->row(y) + x,
                        transmission.row(y) + x, drawn == nullptr ? nullptr : drawn->row(y) + x});
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
}

void place_discs(PaddedImage& transmission, const std::vector<Vec2>& centres,
                 const DiscProfile& disc) {
    const KernelProfile profile(disc);
    DiscWindow& window = scratch_window();
    for (const Vec2 centre : centres) {
        window.enclose(transmission, centre, disc.reach());
        const auto& rows = rows_of(window, centre, nullptr, transmission, &transmission);
        HWY_DYNAMIC_DISPATCH(place_rows)
        (profile.terms(), rows.data(), static_cast<int>(rows.size()));
    }
}

void place_disc(PaddedImage& transmission, Vec2 centre, const DiscProfile& disc) {
    place_discs(transmission, {centre}, disc);
}

double explained_misfit(const PaddedImage& darkness, const PaddedImage& transmission, Vec2 centre,
                        const DiscProfile& disc) {
    const KernelProfile profile(disc);
    DiscWindow& window = scratch_window();
    window.enclose(transmission, centre, disc.reach());
    const auto& rows = rows_of(window, centre, &darkness, transmission, nullptr);
    return HWY_DYNAMIC_DISPATCH(explained_rows)(profile.terms(), rows.data(),
                                                static_cast<int>(rows.size()));
}

}  // namespace grainfield::tracking
#endif
