#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/frame.h"
#include "tracking/model/padded_image.h"

namespace grainfield::tracking {

/// Which pixels of a frame are looked at. Others count no more than those beyond the border: they
/// have no residual, no gradient and no weight, and what is near them is judged as at the border.
class VisiblePixels {
 public:
    /// All of them.
    VisiblePixels() = default;
    /// Those where the mask is above zero.
    explicit VisiblePixels(Image mask) : mask_(std::move(mask)) {
        if (std::ranges::all_of(mask_.pixels(), [](float v) { return v > 0; })) mask_ = {};
    }

    bool are_all() const { return mask_.empty(); }
    bool operator()(int x, int y) const { return mask_.empty() || mask_(x, y) > 0; }
    /// The mask; empty if all are visible.
    const Image& mask() const { return mask_; }

    /// Of the `all` pixels of the frame.
    std::int64_t count(std::int64_t all) const {
        if (mask_.empty()) return all;
        return std::ranges::count_if(mask_.pixels(), [](float v) { return v > 0; });
    }

    /// Those of the part that begins at (x, y).
    VisiblePixels part(int x, int y, int width, int height) const {
        if (mask_.empty()) return {};
        Image part(width, height);
        for (int row = 0; row < height; ++row) {
            std::copy_n(mask_.row(y + row) + x, width, part.row(row));
        }
        return VisiblePixels(std::move(part));
    }

    /// Whole blocks of factor × factor pixels, visible where each of their pixels is.
    VisiblePixels blocks(int factor) const {
        if (mask_.empty()) return {};
        Image blocks(mask_.width() / factor, mask_.height() / factor, 1);
        for (int y = 0; y < blocks.height() * factor; ++y) {
            for (int x = 0; x < blocks.width() * factor; ++x) {
                if (!(mask_(x, y) > 0)) blocks(x / factor, y / factor) = 0;
            }
        }
        return VisiblePixels(std::move(blocks));
    }

    /// Every spacing-th row, from the first one on.
    VisiblePixels every_row(int spacing) const {
        if (mask_.empty()) return {};
        Image rows(mask_.width(), (mask_.height() - 1) / spacing + 1);
        for (int y = 0; y < rows.height(); ++y) {
            std::copy_n(mask_.row(y * spacing), mask_.width(), rows.row(y));
        }
        return VisiblePixels(std::move(rows));
    }

    /// Sets all others as the margin is (disc_kernel.h): darkness 1, transmission 0.
    void hide_others(PaddedImage& image, float value) const {
        for (int y = 0; y < mask_.height(); ++y) {
            const float* seen = mask_.row(y);
            float* row = image.row(y);
            for (int x = 0; x < mask_.width(); ++x) {
                if (!(seen[x] > 0)) row[x] = value;
            }
        }
    }

 private:
    Image mask_;
};

}  // namespace grainfield::tracking
