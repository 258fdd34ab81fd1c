#include "tracking/model/binning.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace grainfield::tracking {
namespace {

constexpr double kSharpest = 0.05;  // [px]

}  // namespace

double Binning::edge_in_blocks(double width) const {
    if (is_none()) return width;
    return std::hypot(width, factor / std::numbers::pi) / factor;
}

DiscProfile Binning::in_blocks(const DiscProfile& disc) const {
    if (is_none()) return disc;
    return {disc.diameter / factor, edge_in_blocks(disc.edge_width), disc.shape};
}

DiscProfile Binning::in_frame(const DiscProfile& disc) const {
    if (is_none()) return disc;
    const double blur = factor / std::numbers::pi;
    const double width = disc.edge_width * factor;
    return {disc.diameter * factor,
            std::max(kSharpest, std::sqrt(std::max(0.0, width * width - blur * blur))), disc.shape};
}

Image Binning::binned(const Image& frame) const {
    Image result;
    bin(frame, result);
    return result;
}

void Binning::bin_row(const float* top, std::ptrdiff_t stride, std::vector<float>& sums, float* row,
                      int columns) const {
    std::copy_n(top, sums.size(), sums.data());
    for (int v = 1; v < factor; ++v) {
        const float* pixels = top + v * stride;
        for (std::size_t x = 0; x < sums.size(); ++x) sums[x] += pixels[x];
    }
    const float share = 1.0F / static_cast<float>(factor * factor);
    const float* in = sums.data();
    for (int x = 0; x < columns; ++x, in += factor) {
        float sum = in[0];
        for (int u = 1; u < factor; ++u) sum += in[u];
        row[x] = sum * share;
    }
}

void Binning::bin(const Image& frame, Image& binned) const {
    const int width = blocks(frame.width());
    const int height = blocks(frame.height());
    if (binned.width() != width || binned.height() != height) binned = Image(width, height);
    std::vector<float> sums(static_cast<std::size_t>(frame.width()));
    for (int y = 0; y < height; ++y) {
        bin_row(frame.row(y * factor), frame.width(), sums, binned.row(y), width);
    }
}

}  // namespace grainfield::tracking
