#include "tracking/image_model.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "tracking/padded_image.h"

namespace grainfield::tracking {
namespace {

constexpr float kLeastSpan = 1e-6F;

}  // namespace

Image ImageModel::darkness(const Image& counts, const Illumination& light) const {
    Image result;
    darkness(counts, light, result);
    return result;
}

void ImageModel::darkness(const Image& counts, const Illumination& light, Image& result,
                          int threads) const {
    if (result.width() != counts.width() || result.height() != counts.height()) {
        result = Image(counts.width(), counts.height());
    }
    const float sign = polarity == Polarity::dark ? 1.0F : -1.0F;
    const auto core = static_cast<float>(dark_level);
    const auto offset = static_cast<float>(light.offset);
    const auto scale = static_cast<float>(1 / light.span);
    const int width = counts.width();
    in_row_bands(width, counts.height(), threads, [&](int first, int last) {
        std::vector<float> clear(static_cast<std::size_t>(width));
        const float* b = clear.data();
        for (int y = first; y < last; ++y) {
            background.row(y, width, clear.data());
            const float* in = counts.row(y);
            float* out = result.row(y);
#pragma omp simd
            for (int x = 0; x < width; ++x) {
                const float span = std::max(sign * (b[x] - core), kLeastSpan);
                const float d = sign * (b[x] - in[x]) / span;
                out[x] = std::min(std::max((d - offset) * scale, -0.5F), 1.5F);
            }
        }
    });
}

ImageModel::PixelDarkness ImageModel::darkness_of(int x, int y) const {
    const float sign = polarity == Polarity::dark ? 1.0F : -1.0F;
    const auto b = static_cast<float>(background(x, y));
    return {b, sign / std::max(sign * (b - static_cast<float>(dark_level)), kLeastSpan)};
}

}  // namespace grainfield::tracking
