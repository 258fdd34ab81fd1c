#pragma once

#include <cstddef>
#include <vector>

#include "core/vec2.h"
#include "tracking/model/kernel_profile.h"

namespace grainfield::tracking {

/// What a band of rows needs to know of all discs that reach it, pixel by pixel: the transmission
/// T = Π_j (1 − P_j), the sum of outward normals Σ_j P_j n_j and Σ_j P_j². In vectors; 0.7 µs a
/// disc at D = 16 px. Memory is kept from band to band.
class BandSums {
 public:
    /// Of rows [first, last) of an image of this width. Discs are added in their order.
    void assign(int width, int first, int last, const std::vector<Vec2>& discs,
                const KernelProfile& profile);

    int width() const { return width_; }
    /// Row y of the image, in [first, last).
    const float* transmission(int y) const { return row(0, y); }
    const float* along_x(int y) const { return row(1, y); }
    const float* along_y(int y) const { return row(2, y); }
    const float* squares(int y) const { return row(3, y); }

 private:
    static constexpr int kPlanes = 4;
    const float* row(int plane, int y) const { return values_.data() + offset(plane, y); }
    std::size_t offset(int plane, int y) const {
        return (static_cast<std::size_t>(y - first_) * kPlanes + static_cast<std::size_t>(plane)) *
                   stride_ +
               margin_;
    }

    int width_ = 0, first_ = 0;
    std::size_t stride_ = 0, margin_ = 0;
    std::vector<float> values_;  ///< the planes of a row one after the other
};

}  // namespace grainfield::tracking
