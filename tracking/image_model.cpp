#include "tracking/image_model.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace grainfield::tracking {
namespace {

constexpr float kLeastSpan = 1e-6F;

}  // namespace

Image ImageModel::darkness(const Image& counts, const Illumination& light) const {
    Image result(counts.width(), counts.height());
    const float sign = polarity == Polarity::dark ? 1.0F : -1.0F;
    const auto core = static_cast<float>(dark_level);
    const auto offset = static_cast<float>(light.offset);
    const auto scale = static_cast<float>(1 / light.span);
    std::vector<float> clear(static_cast<std::size_t>(counts.width()));
    for (int y = 0; y < counts.height(); ++y) {
        background.row(y, counts.width(), clear.data());
        const float* in = counts.row(y);
        float* out = result.row(y);
        for (int x = 0; x < counts.width(); ++x) {
            const float b = clear[static_cast<std::size_t>(x)];
            const float d = sign * (b - in[x]) / std::max(sign * (b - core), kLeastSpan);
            out[x] = std::clamp((d - offset) * scale, -0.5F, 1.5F);
        }
    }
    return result;
}

float ImageModel::darkness_at(const Image& counts, int x, int y) const {
    const float sign = polarity == Polarity::dark ? 1.0F : -1.0F;
    const auto b = static_cast<float>(background(x, y));
    return sign * (b - counts(x, y)) /
           std::max(sign * (b - static_cast<float>(dark_level)), kLeastSpan);
}

}  // namespace grainfield::tracking
