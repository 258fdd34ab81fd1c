#include "simulate/render/sensor/gaussian_blur.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/support/parallel.h"

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define GRAINFIELD_BLUR_KERNEL __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define GRAINFIELD_BLUR_KERNEL
#endif

namespace grainfield::simulate {

namespace {

constexpr int rows_per_band = 32;

// out[x] = Σ_j weight[j] in[j · stride + x]. Symmetric weights; blocks stay in registers.
GRAINFIELD_BLUR_KERNEL void weighted_rows(const float* __restrict in, std::ptrdiff_t stride,
                                          const float* __restrict weight, int taps, int count,
                                          float* __restrict out) {
    constexpr int block = 64;
    int x = 0;
    for (; x + block <= count; x += block) {
        float sum[block] = {};
        for (int j = 0; j < taps; ++j) {
            const float* __restrict from = in + j * stride + x;
            const float w = weight[j];
            for (int i = 0; i < block; ++i) sum[i] += w * from[i];
        }
        for (int i = 0; i < block; ++i) out[x + i] = sum[i];
    }
    for (; x < count; ++x) {
        float sum = 0;
        for (int j = 0; j < taps; ++j) sum += weight[j] * in[j * stride + x];
        out[x] = sum;
    }
}

std::vector<float> gaussian_weights(double sigma) {
    const int reach = blur_reach(sigma);
    const int size = 2 * reach + 1;
    std::vector<double> weight(static_cast<std::size_t>(size));
    double sum = 0;
    for (int j = -reach; j <= reach; ++j) {
        const double w = std::exp(-0.5 * j * j / (sigma * sigma));
        const int index = j + reach;
        weight[static_cast<std::size_t>(index)] = w;
        sum += w;
    }
    std::vector<float> normalised;
    for (const double w : weight) normalised.push_back(static_cast<float>(w / sum));
    return normalised;
}

}  // namespace

int blur_reach(double sigma) {
    return static_cast<int>(std::ceil(4 * sigma));
}

Image gaussian_blur(const Image& image, double sigma, int threads) {
    if (sigma <= 0) return image;
    const int reach = blur_reach(sigma);
    const std::vector<float> weight = gaussian_weights(sigma);
    const int taps = static_cast<int>(weight.size());
    const int width = std::max(0, image.width() - 2 * reach);
    const int height = std::max(0, image.height() - 2 * reach);
    Image out(width, height);
    if (out.empty()) return out;
    const int bands = (height + rows_per_band - 1) / rows_per_band;
    parallel_for(bands, threads, [&](std::int64_t b) {
        const int first = static_cast<int>(b) * rows_per_band;
        const int rows = std::min(rows_per_band, height - first);
        std::vector<float> column(static_cast<std::size_t>(image.width()));
        for (int y = first; y < first + rows; ++y) {
            weighted_rows(image.row(y), image.width(), weight.data(), taps, image.width(),
                          column.data());
            weighted_rows(column.data(), 1, weight.data(), taps, width, out.row(y));
        }
    });
    return out;
}

}  // namespace grainfield::simulate
