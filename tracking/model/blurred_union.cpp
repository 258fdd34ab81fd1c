#include "tracking/model/blurred_union.h"

#include <algorithm>

namespace grainfield::tracking {
namespace {

constexpr float kFirstOrder = 3.5F;

}  // namespace

void BlurredUnion::add_to(const DiscBand& discs, Image& darkness) const {
    const int width = darkness.width();
    for (int y = discs.first; y < discs.last; ++y) {
        const float* vx = discs.sums.along_x(y);
        const float* vy = discs.sums.along_y(y);
        const float* squares = discs.sums.squares(y);
        const float* transmission = discs.sums.transmission(y);
        float* out = darkness.row(y);
#pragma omp simd
        for (int x = 0; x < width; ++x) {
            const float c = kFirstOrder / 2 * (vx[x] * vx[x] + vy[x] * vy[x] - squares[x]);
            out[x] += std::min(std::max(c, -1.0F), 2.0F) * transmission[x];
        }
    }
}

}  // namespace grainfield::tracking
