#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/frame.h"
#include "core/support/huge_pages.h"
#include "core/support/parallel.h"

namespace grainfield::tracking {

/// Calls body(first, last) for bands of rows that cover an image, in parallel where it is large
/// enough to be worth the start of threads.
template <class Body>
void in_row_bands(int width, int height, int threads, Body&& body) {
    constexpr std::int64_t kWorthAThread = std::int64_t{1} << 19;
    constexpr int kRows = 64;
    const bool is_large = std::int64_t{width} * height >= kWorthAThread;
    parallel_for((height + kRows - 1) / kRows, is_large ? threads : 1, [&](std::int64_t band) {
        const int first = static_cast<int>(band) * kRows;
        body(first, std::min(height, first + kRows));
    });
}

/// An image with a margin of constant pixels around it, so that kernels need not ask where it ends.
class PaddedImage {
 public:
    /// Vectors may run this far beyond the margin.
    static constexpr int kMostLanes = 16;

    PaddedImage(int width, int height, int margin, float inside, float outside)
        : width_(width),
          height_(height),
          margin_(margin),
          stride_(static_cast<std::size_t>(width) +
                  2 * static_cast<std::size_t>(margin + kMostLanes)),
          pixels_(
              stride_ * (static_cast<std::size_t>(height) + 2 * static_cast<std::size_t>(margin)),
              outside) {
        if (inside == outside) return;
        fill(inside);
    }
    PaddedImage(const Image& image, int margin, float outside)
        : PaddedImage(image.width(), image.height(), margin, outside, outside) {
        assign(image);
    }

    /// Takes over the pixels of an image of the same size; the margin stays.
    void assign(const Image& image) {
        for (int y = 0; y < height_; ++y) std::copy_n(image.row(y), width_, row(y));
    }
    /// Sets every pixel inside the margin.
    void fill(float value) {
        for (int y = 0; y < height_; ++y) std::fill_n(row(y), width_, value);
    }

    int width() const { return width_; }
    int height() const { return height_; }
    int margin() const { return margin_; }
    /// Pixels from one row to the next.
    std::ptrdiff_t pitch() const { return static_cast<std::ptrdiff_t>(stride_); }

    /// Pixel (0, y), y in [−margin, height + margin); x may run over [−margin, width + margin).
    float* row(int y) { return pixels_.data() + offset(y); }
    const float* row(int y) const { return pixels_.data() + offset(y); }
    float operator()(int x, int y) const { return row(y)[x]; }

    /// Asks for pixels [x0, x1) × [y0, y1) ahead of their use; those beyond the image are left out.
    void fetch(int x0, int y0, int x1, int y1) const {
        constexpr int kLine = 16;  // floats
        for (int y = std::max(y0, 0); y < std::min(y1, height_); ++y) {
            const float* pixels = row(y);
            for (int x = std::max(x0, 0); x < std::min(x1, width_); x += kLine) {
                fetch_line(pixels + x);
            }
        }
    }

    Image inner() const {
        Image image;
        copy_to(image);
        return image;
    }
    /// Without the margin, into an image whose memory is kept if it has that size.
    void copy_to(Image& image) const {
        if (image.width() != width_ || image.height() != height_) image = Image(width_, height_);
        for (int y = 0; y < height_; ++y) std::copy_n(row(y), width_, image.row(y));
    }

 private:
    std::size_t offset(int y) const {
        return static_cast<std::size_t>(y + margin_) * stride_ +
               static_cast<std::size_t>(margin_ + kMostLanes);
    }

    int width_;
    int height_;
    int margin_;
    std::size_t stride_;
    HugeVector<float> pixels_;
};

}  // namespace grainfield::tracking
