#include "tracking/model/image_model.h"

#include <algorithm>
#include <cmath>

namespace grainfield::tracking {
namespace {

constexpr float kLeastSpan = 1e-6F;

}  // namespace

ImageModel ImageModel::in_pixels() const {
    ImageModel model = *this;
    model.binning = {};
    if (binning.is_none()) return model;
    model.disc = binning.in_frame(disc);
    model.background = background.in_pixels(binning.factor);
    model.correction.spacing *= binning.factor;
    model.noise *= binning.factor;
    const double misfit = std::max(0.0, residual_rms * residual_rms - noise * noise);
    model.residual_rms = std::sqrt(misfit + model.noise * model.noise);
    return model;
}

Image ImageModel::darkness(const Image& counts, const Illumination& light) const {
    Image result(counts.width(), counts.height());
    for (int y = 0; y < counts.height(); ++y) darkness_row(counts, light, y, result.row(y));
    return result;
}

void ImageModel::darkness_row(const Image& counts, const Illumination& light, int y,
                              float* out) const {
    const float sign = polarity == Polarity::dark ? 1.0F : -1.0F;
    const auto core = static_cast<float>(dark_level);
    const auto offset = static_cast<float>(light.offset);
    const auto scale = static_cast<float>(1 / light.span);
    const int width = counts.width();
    const float* in = counts.row(y);
    if (background.is_uniform()) {
        const auto clear = static_cast<float>(background(0, 0));
        const float per_count = scale * sign / std::max(sign * (clear - core), kLeastSpan);
        const float at_zero = per_count * clear - offset * scale;
#pragma omp simd
        for (int x = 0; x < width; ++x) {
            out[x] = std::min(std::max(at_zero - per_count * in[x], -0.5F), 1.5F);
        }
        return;
    }
    background.row(y, width, out);
#pragma omp simd
    for (int x = 0; x < width; ++x) {
        const float clear = out[x];
        const float span = std::max(sign * (clear - core), kLeastSpan);
        const float d = sign * (clear - in[x]) / span;
        out[x] = std::min(std::max((d - offset) * scale, -0.5F), 1.5F);
    }
}

ImageModel::PixelDarkness ImageModel::darkness_of(int x, int y) const {
    const float sign = polarity == Polarity::dark ? 1.0F : -1.0F;
    const auto b = static_cast<float>(background(x, y));
    return {b, sign / std::max(sign * (b - static_cast<float>(dark_level)), kLeastSpan)};
}

}  // namespace grainfield::tracking
