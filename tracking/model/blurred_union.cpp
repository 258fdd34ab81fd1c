#include "tracking/model/blurred_union.h"

#include <algorithm>

namespace grainfield::tracking {
namespace {

constexpr float kFirstOrder = 3.5F;
constexpr float kLeastDistance = 1e-3F;  // [px]

}  // namespace

void BlurredUnion::add_to(const DiscBand& discs, Image& darkness) const {
    const int width = darkness.width();
    const int rows = discs.last - discs.first;
    Image along_x(width, rows);
    Image along_y(width, rows);
    Image squares(width, rows);
    // In the core nothing passes whatever the others do.
    const float inner = std::max(
        0.0F, 2 * static_cast<float>(discs.disc.radius()) - static_cast<float>(discs.disc.reach()));
    discs.each_pixel(inner, [&](int x, int row, const DiscPixel& p) {
        const float dark = discs.profile.darkness(p.r);
        const float share = dark / std::max(p.r, kLeastDistance);
        along_x(x, row) += share * p.dx;
        along_y(x, row) += share * p.dy;
        squares(x, row) += dark * dark;
    });
    for (int y = discs.first; y < discs.last; ++y) {
        const float* vx = along_x.row(y - discs.first);
        const float* vy = along_y.row(y - discs.first);
        const float* dark2 = squares.row(y - discs.first);
        const float* transmission = discs.transmission.row(y);
        float* out = darkness.row(y);
        for (int x = 0; x < width; ++x) {
            const float c = kFirstOrder / 2 * (vx[x] * vx[x] + vy[x] * vy[x] - dark2[x]);
            out[x] += std::clamp(c, -1.0F, 2.0F) * transmission[x];
        }
    }
}

}  // namespace grainfield::tracking
