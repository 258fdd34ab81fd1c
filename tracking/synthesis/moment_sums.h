#pragma once

#include <array>
#include <cstddef>

namespace grainfield::tracking {

/// An image as the kernels want it: pointer to its first pixel, pixels from row to row.
struct PixelRows {
    const float* first = nullptr;
    std::ptrdiff_t stride = 0;
    int width = 0, height = 0;

    template <class AnImage>
    static PixelRows of(const AnImage& image) {
        return {image.row(0), image.row(1) - image.row(0), image.width(), image.height()};
    }
};

/// Moments h_m of the picture about a sphere, and sums over their products (BiasTerms), in vectors.
///
/// A source is a ring of one of two images. Sources are numbered ring + kLanes × image: the last
/// one of each image is a place holder with radius 0, whose weights are 0.
class MomentSums {
 public:
    static constexpr int kRings = 7;
    static constexpr std::size_t kLanes = 8;  ///< rings, and the place holder
    static constexpr std::size_t kSources = 2 * kLanes;
    static constexpr std::size_t kOrders = 5;  ///< 0 … 4

    /// By order and source.
    struct Moments {
        alignas(64) std::array<std::array<float, kSources>, kOrders> real, imaginary;
    };
    /// Of h_1 of each source, and of h_{m+1,p} h*_{m,q}.
    struct Weights {
        alignas(64) std::array<float, kSources> first{};
        alignas(64)
            std::array<std::array<std::array<float, kSources>, kSources>, kOrders - 1> product{};
    };
    struct Sum {
        float x, y;
    };

    /// `radii` [px], ascending; all rings lie in the images, which are read between pixels. Beyond
    /// the middles of the last two pixels the line through them goes on.
    /// `residual`: an image, to which darkness − 1 is added if `is_transmission`.
    static Moments moments(const PixelRows& darkness, const PixelRows& residual,
                           bool is_transmission, const std::array<float, kRings>& radii, float x,
                           float y);
    /// Σ weight × term.
    static Sum weighted(const Moments& h, const Weights& weights);
};

}  // namespace grainfield::tracking
