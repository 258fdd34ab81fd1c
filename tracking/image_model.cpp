#include "tracking/image_model.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace grainfield::tracking {
namespace {

constexpr float kLeastSpan = 1e-6F;

}  // namespace

Image ImageModel::darkness(const Image& counts, const Illumination& light) const {
    Image result;
    darkness(counts, light, result);
    return result;
}

void ImageModel::darkness(const Image& counts, const Illumination& light, Image& result) const {
    if (result.width() != counts.width() || result.height() != counts.height()) {
        result = Image(counts.width(), counts.height());
    }
    const float sign = polarity == Polarity::dark ? 1.0F : -1.0F;
    const auto core = static_cast<float>(dark_level);
    const auto offset = static_cast<float>(light.offset);
    const auto scale = static_cast<float>(1 / light.span);
    const int width = counts.width();
    std::vector<float> clear(static_cast<std::size_t>(counts.width()));
    for (int y = 0; y < counts.height(); ++y) {
        background.row(y, counts.width(), clear.data());
        const float* in = counts.row(y);
        float* out = result.row(y);
        const float* b = clear.data();
#pragma omp simd
        for (int x = 0; x < width; ++x) {
            const float span = std::max(sign * (b[x] - core), kLeastSpan);
            const float d = sign * (b[x] - in[x]) / span;
            out[x] = std::min(std::max((d - offset) * scale, -0.5F), 1.5F);
        }
    }
}

float ImageModel::darkness_at(const Image& counts, int x, int y) const {
    const float sign = polarity == Polarity::dark ? 1.0F : -1.0F;
    const auto b = static_cast<float>(background(x, y));
    return sign * (b - counts(x, y)) /
           std::max(sign * (b - static_cast<float>(dark_level)), kLeastSpan);
}

}  // namespace grainfield::tracking
