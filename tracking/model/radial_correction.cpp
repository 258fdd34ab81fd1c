#include "tracking/model/radial_correction.h"

namespace grainfield::tracking {

void RadialCorrection::add_to(const DiscBand& discs, Image& darkness) const {
    Image light(darkness.width(), discs.last - discs.first, 1.0F);
    discs.each_pixel(0, [&](int x, int row, const DiscPixel& p) {
        light(x, row) *= 1 - discs.profile.darkness(p.r) - (*this)(p.r);
    });
    for (int y = discs.first; y < discs.last; ++y) {
        const float* lit = light.row(y - discs.first);
        const float* transmission = discs.sums.transmission(y);
        float* out = darkness.row(y);
        for (int x = 0; x < darkness.width(); ++x) out[x] += lit[x] - transmission[x];
    }
}

}  // namespace grainfield::tracking
