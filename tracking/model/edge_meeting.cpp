#include "tracking/model/edge_meeting.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/support/parallel.h"

namespace grainfield::tracking {
namespace {

constexpr float kFirstOrder = 3.5F;
constexpr float kLeast = 1e-3F;
constexpr int kBand = 64;

/// The pixels of rows [first, last) that a disc reaches but for its core: action(x, y − first, r,
/// offset from the centre).
template <class Action>
void visit(Vec2 p, float inner, float outer, int width, int first, int last, Action&& action) {
    const auto cx = static_cast<float>(p.x);
    const auto cy = static_cast<float>(p.y);
    const int y0 = std::max(first, static_cast<int>(std::ceil(cy - outer)));
    const int y1 = std::min(last - 1, static_cast<int>(std::floor(cy + outer)));
    const int x0 = std::max(0, static_cast<int>(std::ceil(cx - outer)));
    const int x1 = std::min(width - 1, static_cast<int>(std::floor(cx + outer)));
    for (int y = y0; y <= y1; ++y) {
        const float dy = static_cast<float>(y) - cy;
        for (int x = x0; x <= x1; ++x) {
            const float dx = static_cast<float>(x) - cx;
            const float r2 = dx * dx + dy * dy;
            if (r2 > outer * outer || r2 < inner * inner) continue;
            action(x, y - first, std::sqrt(r2), dx, dy);
        }
    }
}

float darkness_of(float r, const DiscProfile& disc) {
    const auto radius = static_cast<float>(disc.radius());
    const auto steepness = static_cast<float>(2 / disc.edge_width);
    return 1 / (1 + std::exp(steepness * (r - radius)));
}

/// What is summed over discs for rows [first, last): P n, P n and P² where edges meet as those of a
/// blurred union, and what a learned profile lets pass.
struct Sums {
    int first, last;
    Image along_x, along_y, squares, light;

    Sums(int width, int from, int to, EdgeMeeting meeting, const RadialCorrection& correction)
        : first(from), last(to) {
        if (meeting == EdgeMeeting::blurred_union) {
            along_x = along_y = squares = Image(width, to - from);
        }
        if (!correction.is_zero()) light = Image(width, to - from, 1.0F);
    }

    void add(Vec2 p, const DiscProfile& disc) {
        const auto outer = static_cast<float>(disc.reach());
        // In the core nothing passes whatever the others do.
        const float inner = std::max(0.0F, 2 * static_cast<float>(disc.radius()) - outer);
        visit(p, inner, outer, squares.width(), first, last,
              [&](int x, int y, float r, float dx, float dy) {
                  const float dark = darkness_of(r, disc);
                  const float share = dark / std::max(r, kLeast);
                  along_x(x, y) += share * dx;
                  along_y(x, y) += share * dy;
                  squares(x, y) += dark * dark;
              });
    }

    void dim(Vec2 p, const DiscProfile& disc, const RadialCorrection& correction) {
        visit(p, 0, static_cast<float>(disc.reach()), light.width(), first, last,
              [&](int x, int y, float r, float, float) {
                  light(x, y) *= 1 - darkness_of(r, disc) - correction(r);
              });
    }
};

}  // namespace

Image as_product(const Image& darkness, const PaddedImage& transmission,
                 const std::vector<Vec2>& positions, const DiscProfile& disc, int threads,
                 EdgeMeeting meeting, const RadialCorrection& correction) {
    Image result = darkness;
    const int bands = (darkness.height() + kBand - 1) / kBand;
    // In order of index within each band, whoever computes it.
    std::vector<std::vector<std::size_t>> members(static_cast<std::size_t>(bands));
    for (std::size_t j = 0; j < positions.size(); ++j) {
        const double y = positions[j].y;
        const int low = static_cast<int>(std::floor((y - disc.reach()) / kBand));
        const int high = static_cast<int>(std::floor((y + disc.reach()) / kBand));
        for (int b = std::max(0, low); b <= std::min(bands - 1, high); ++b) {
            members[static_cast<std::size_t>(b)].push_back(j);
        }
    }
    parallel_for(bands, threads, [&](std::int64_t band) {
        const int first = static_cast<int>(band) * kBand;
        Sums sums(darkness.width(), first, std::min(darkness.height(), first + kBand), meeting,
                  correction);
        for (const std::size_t j : members[static_cast<std::size_t>(band)]) {
            if (!sums.squares.empty()) sums.add(positions[j], disc);
            if (!sums.light.empty()) sums.dim(positions[j], disc, correction);
        }
        for (int y = first; y < sums.last; ++y) {
            if (!sums.squares.empty()) {
                const float* vx = sums.along_x.row(y - first);
                const float* vy = sums.along_y.row(y - first);
                const float* squares = sums.squares.row(y - first);
                for (int x = 0; x < darkness.width(); ++x) {
                    const float c = kFirstOrder / 2 * (vx[x] * vx[x] + vy[x] * vy[x] - squares[x]);
                    result(x, y) += std::clamp(c, -1.0F, 2.0F) * transmission(x, y);
                }
            }
            if (!sums.light.empty()) {
                const float* light = sums.light.row(y - first);
                for (int x = 0; x < darkness.width(); ++x) {
                    result(x, y) += light[x] - transmission(x, y);
                }
            }
        }
    });
    return result;
}

}  // namespace grainfield::tracking
