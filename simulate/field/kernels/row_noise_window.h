#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>

#include "simulate/field/kernels/aligned_vector.h"
#include "simulate/field/kernels/row_kernel.h"

namespace grainfield::simulate {

/// The face noises of consecutive rows, each drawn once: row y has faces along x and, in two
/// dimensions, those towards row y + 1. Line 2y and 2y + 1 of the stream, so that a row can be
/// drawn again.
class RowNoiseWindow {
 public:
    using Fill = std::function<void(std::uint32_t line, std::span<float> out)>;

    RowNoiseWindow(int nx, int ny, int dimension, const Fill& fill)
        : ny_(ny), has_y_(dimension == 2), fill_(fill) {
        for (auto* row : {&x_, &below_, &above_}) row->assign(static_cast<std::size_t>(nx), 0);
    }

    /// The noises round row y; rows must be taken in growing order (round the ring).
    RowNoise at(int y) {
        const int row = (y + ny_) % ny_;
        if (has_y_) {
            if (row == next_) {
                below_.swap(above_);
            } else {
                fill_(2 * static_cast<std::uint32_t>((row + ny_ - 1) % ny_) + 1, below_);
            }
            fill_(2 * static_cast<std::uint32_t>(row) + 1, above_);
            next_ = (row + 1) % ny_;
        }
        fill_(2 * static_cast<std::uint32_t>(row), x_);
        return {x_.data(), below_.data(), above_.data()};
    }

 private:
    int ny_;
    bool has_y_;
    const Fill& fill_;
    int next_ = -1;
    AlignedVector<float> x_, below_, above_;
};

}  // namespace grainfield::simulate
