#include "tracking/refine/disc_kernel.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

// The row kernels below are plain loops that the compiler vectorises. On x86-64 they are compiled
// twice and chosen at run time, so that one binary uses AVX2 where the machine has it. Sanitizers
// do not get along with the run-time choice.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define GRAINFIELD_ROW_KERNEL __attribute__((target_clones("default", "avx2")))
#else
#define GRAINFIELD_ROW_KERNEL
#endif

namespace grainfield::tracking {
namespace {

/// exp(x) for |x| ≤ 20, relative error < 3e-7: 2^k times a degree-6 polynomial on |f| ≤ ln2/2.
inline float exp_small(float x) {
    const float scaled = x * 1.44269504F;
    const auto k = static_cast<std::int32_t>(scaled + 64.5F) - 64;
    const float f =
        (x - static_cast<float>(k) * 0.693359375F) + static_cast<float>(k) * 2.12194440e-4F;
    const float p =
        1.0F +
        f * (1.0F +
             f * (0.5F + f * (0.166666667F +
                              f * (0.0416666667F + f * (0.00833333333F + f * 0.00138888889F)))));
    return p * std::bit_cast<float>((k + 127) << 23);
}

/// What a row kernel needs to know of a disc.
struct RowDisc {
    float x;    ///< centre, relative to the first pixel of the row
    float dy2;  ///< squared vertical distance of the row to the centre
    float radius;
    float two_over_width;
    float reach;
};

inline float transmission_at(float distance, const RowDisc& d) {
    constexpr float kLimit = 2.0F * static_cast<float>(DiscProfile::kReachInWidths);
    const float u2 = std::min(std::max((distance - d.radius) * d.two_over_width, -kLimit), kLimit);
    const float t = 1.0F / (1.0F + exp_small(-u2));
    return distance < d.reach ? t : 1.0F;
}

GRAINFIELD_ROW_KERNEL
void transmission_row(const RowDisc& d, int n, float* t) {
    const RowDisc disc = d;
#pragma omp simd
    for (int i = 0; i < n; ++i) {
        const float dx = static_cast<float>(i) - disc.x;
        t[i] = transmission_at(std::sqrt(dx * dx + disc.dy2), disc);
    }
}

struct RowSums {
    float xx, xr, rr, bx, br, misfit;
};

/// Sums over one row with J = g · (dx, dy), g = T (2/w) P / r; dy is constant along the row and
/// multiplied in by the caller (xr: Σ g² dx, rr: Σ g², br: Σ g res).
GRAINFIELD_ROW_KERNEL
RowSums normal_row(const RowDisc& d, int n, const float* darkness, const float* transmission) {
    const RowDisc disc = d;
    float xx = 0;
    float xr = 0;
    float rr = 0;
    float bx = 0;
    float br = 0;
    float misfit = 0;
#pragma omp simd reduction(+ : xx, xr, rr, bx, br, misfit)
    for (int i = 0; i < n; ++i) {
        const float dx = static_cast<float>(i) - disc.x;
        const float r = std::sqrt(dx * dx + disc.dy2);
        const float p = 1.0F - transmission_at(r, disc);
        const float residual = darkness[i] - 1.0F + transmission[i];
        const float g = transmission[i] * disc.two_over_width * p / (r + 1e-6F);
        const float gx = g * dx;
        xx += gx * gx;
        xr += gx * g;
        rr += g * g;
        bx += gx * residual;
        br += g * residual;
        misfit += residual * residual;
    }
    return {xx, xr, rr, bx, br, misfit};
}

/// T ← T · after/before; returns the change of Σ (I − 1 + T)².
GRAINFIELD_ROW_KERNEL
float move_row(int n, const float* darkness, float* transmission, const float* before,
               const float* after) {
    float change = 0;
#pragma omp simd reduction(+ : change)
    for (int i = 0; i < n; ++i) {
        const float moved = transmission[i] * (after[i] / before[i]);
        const float old_residual = darkness[i] - 1.0F + transmission[i];
        const float new_residual = darkness[i] - 1.0F + moved;
        change += new_residual * new_residual - old_residual * old_residual;
        transmission[i] = moved;
    }
    return change;
}

/// Σ [(I − 1 + T/t)² − (I − 1 + T)²].
GRAINFIELD_ROW_KERNEL
float explained_row(int n, const float* darkness, const float* transmission, const float* t) {
    float gain = 0;
#pragma omp simd reduction(+ : gain)
    for (int i = 0; i < n; ++i) {
        const float residual = darkness[i] - 1.0F + transmission[i];
        const float lifted = darkness[i] - 1.0F + transmission[i] / t[i];
        gain += lifted * lifted - residual * residual;
    }
    return gain;
}

/// The pixels of one image row that a disc reaches: the chord, widened to whole vectors where the
/// row has room, because a vector costs as much as the single pixel of a remainder loop.
struct Chord {
    int first = 0;
    int count = 0;
};

Chord chord_of(int width, double x_low, double x_high, double dy, double reach) {
    constexpr int kLanes = 8;
    const double half2 = reach * reach - dy * dy;
    if (half2 <= 0) return {};
    const double half = std::sqrt(half2);
    const int first = std::max(0, static_cast<int>(std::ceil(x_low - half)));
    const int last = std::min(width - 1, static_cast<int>(std::floor(x_high + half)));
    if (last < first) return {};
    const int whole = (last - first + kLanes) / kLanes * kLanes;
    return {std::max(0, std::min(first, width - whole)), std::min(whole, width)};
}

/// Calls action(y, chord) for the rows of the image within reach of the segment from–to.
template <class Action>
void for_each_row(const Image& image, Vec2 from, Vec2 to, double reach, Action&& action) {
    const double y_low = std::min(from.y, to.y);
    const double y_high = std::max(from.y, to.y);
    const double x_low = std::min(from.x, to.x);
    const double x_high = std::max(from.x, to.x);
    const int y1 = std::min(image.height() - 1, static_cast<int>(std::floor(y_high + reach)));
    for (int y = std::max(0, static_cast<int>(std::ceil(y_low - reach))); y <= y1; ++y) {
        const double dy = std::max({0.0, y_low - y, y - y_high});
        const Chord chord = chord_of(image.width(), x_low, x_high, dy, reach);
        if (chord.count > 0) action(y, chord);
    }
}

RowDisc row_disc(const DiscProfile& disc, Vec2 centre, const Chord& chord, int y) {
    const double dy = y - centre.y;
    return {static_cast<float>(centre.x - chord.first), static_cast<float>(dy * dy),
            static_cast<float>(disc.radius()), static_cast<float>(2 / disc.edge_width),
            static_cast<float>(disc.reach())};
}

float* scratch(int n, int which) {
    thread_local std::vector<float> buffer[2];
    auto& b = buffer[which];
    if (b.size() < static_cast<std::size_t>(n)) b.resize(static_cast<std::size_t>(n));
    return b.data();
}

}  // namespace

NormalEquations normal_equations(const Image& darkness, const Image& transmission, Vec2 centre,
                                 const DiscProfile& disc) {
    NormalEquations sum;
    for_each_row(darkness, centre, centre, disc.reach(), [&](int y, const Chord& chord) {
        const RowSums row =
            normal_row(row_disc(disc, centre, chord, y), chord.count, darkness.row(y) + chord.first,
                       transmission.row(y) + chord.first);
        const double dy = y - centre.y;
        sum.xx += static_cast<double>(row.xx);
        sum.xy += dy * static_cast<double>(row.xr);
        sum.yy += dy * dy * static_cast<double>(row.rr);
        sum.bx += static_cast<double>(row.bx);
        sum.by += dy * static_cast<double>(row.br);
        sum.misfit += static_cast<double>(row.misfit);
        sum.pixels += chord.count;
    });
    return sum;
}

void place_disc(Image& transmission, Vec2 centre, const DiscProfile& disc) {
    for_each_row(transmission, centre, centre, disc.reach(), [&](int y, const Chord& chord) {
        float* t = scratch(chord.count, 0);
        transmission_row(row_disc(disc, centre, chord, y), chord.count, t);
        float* row = transmission.row(y) + chord.first;
        for (int i = 0; i < chord.count; ++i) row[i] *= t[i];
    });
}

void lift_disc(Image& transmission, Vec2 centre, const DiscProfile& disc) {
    for_each_row(transmission, centre, centre, disc.reach(), [&](int y, const Chord& chord) {
        float* t = scratch(chord.count, 0);
        transmission_row(row_disc(disc, centre, chord, y), chord.count, t);
        float* row = transmission.row(y) + chord.first;
        for (int i = 0; i < chord.count; ++i) row[i] /= t[i];
    });
}

double move_disc(const Image& darkness, Image& transmission, Vec2 from, Vec2 to,
                 const DiscProfile& disc) {
    double change = 0;
    for_each_row(darkness, from, to, disc.reach(), [&](int y, const Chord& chord) {
        float* before = scratch(chord.count, 0);
        float* after = scratch(chord.count, 1);
        transmission_row(row_disc(disc, from, chord, y), chord.count, before);
        transmission_row(row_disc(disc, to, chord, y), chord.count, after);
        change += static_cast<double>(move_row(chord.count, darkness.row(y) + chord.first,
                                               transmission.row(y) + chord.first, before, after));
    });
    return change;
}

double explained_misfit(const Image& darkness, const Image& transmission, Vec2 centre,
                        const DiscProfile& disc) {
    double gain = 0;
    for_each_row(darkness, centre, centre, disc.reach(), [&](int y, const Chord& chord) {
        float* t = scratch(chord.count, 0);
        transmission_row(row_disc(disc, centre, chord, y), chord.count, t);
        gain += static_cast<double>(explained_row(chord.count, darkness.row(y) + chord.first,
                                                  transmission.row(y) + chord.first, t));
    });
    return gain;
}

}  // namespace grainfield::tracking
