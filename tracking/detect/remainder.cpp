#include "tracking/detect/remainder.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace grainfield::tracking {
namespace {

/// A larger deviation belongs to a missing sphere, of darkness 1 where nothing covers it, and not
/// to the misfit of the model: rims and meeting edges leave less.
constexpr float kMissing = 0.25F;          // [contrast]
constexpr std::size_t kLeastPixels = 100;  // that show the noise
/// Flat pixels that vary by this share of what is left about the spheres, and neighbouring ones
/// that differ by less than this share of it: what flat pixels show is not the noise of the layer.
constexpr double kAlike = 0.8;

/// RMS, outliers beyond four robust standard deviations left out. Where half of the values are 0,
/// as in frames of few grey levels, none are.
double robust_rms(std::vector<float>& sizes) {
    if (sizes.empty()) return 0;
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    const float widest =
        *middle > 0 ? 4 * 1.4826F * *middle : std::numeric_limits<float>::infinity();
    double sum = 0;
    double n = 0;
    for (const float size : sizes) {
        if (size > widest) continue;
        sum += static_cast<double>(size) * static_cast<double>(size);
        n += 1;
    }
    return std::sqrt(sum / n);
}

/// Where the noise of a frame shows.
struct NoiseSamples {
    std::vector<float> flat;   ///< image − model of clear pixels and of cores
    std::vector<float> clear;  ///< of clear pixels alone
    /// Second differences of image − model along the rows, of white noise √6 of it. Structure that
    /// is wider than three pixels is not in them.
    std::vector<float> bends, clear_bends;

    /// RMS [contrast]. `left`: RMS of image − model where there are spheres. That of flat pixels,
    /// unless they are few, or not flat in the image, or so bright that they have more photon noise
    /// than the layer.
    double noise(double left) {
        double of_neighbours = robust_rms(bends) / std::sqrt(6.0);
        // What a camera or codec has smoothed varies less from pixel to pixel.
        if (clear_bends.size() >= kLeastPixels) {
            const double white = robust_rms(clear_bends) / std::sqrt(6.0);
            if (white > 0) of_neighbours *= std::max(1.0, robust_rms(clear) / white);
        }
        if (flat.size() < kLeastPixels) return of_neighbours;
        const double of_flat = robust_rms(flat);
        const bool is_no_noise = of_flat > kAlike * left && of_neighbours < kAlike * of_flat;
        return is_no_noise ? of_neighbours : of_flat;
    }
};

}  // namespace

Remainder remainder(const PaddedImage& darkness, const PaddedImage& transmission) {
    constexpr double kSample = 3e4;
    constexpr float kClear = 0.995F;
    const double pixels = static_cast<double>(darkness.width()) * darkness.height();
    const int stride = std::max(1, static_cast<int>(pixels / kSample));
    NoiseSamples samples;
    double squares = 0;
    double covered = 0;
    for (int y = stride / 2; y < darkness.height(); y += stride) {
        const float* d = darkness.row(y);
        const float* t = transmission.row(y);
        for (int x = 0; x < darkness.width(); ++x) {
            if (t[x] <= 0) continue;  // not visible
            const float deviation = std::abs(d[x] - 1.0F + t[x]);
            const bool is_clear = t[x] > kClear;
            const bool is_middle_of_three = x % 3 == 1 && x + 1 < darkness.width();
            if (is_middle_of_three && t[x - 1] > 0 && t[x + 1] > 0) {
                const float bend =
                    std::abs(d[x - 1] + t[x - 1] + d[x + 1] + t[x + 1] - 2 * (d[x] + t[x]));
                samples.bends.push_back(bend);
                if (is_clear && t[x - 1] > kClear && t[x + 1] > kClear) {
                    samples.clear_bends.push_back(bend);
                }
            }
            if (is_clear) samples.clear.push_back(deviation);
            if (is_clear || t[x] < 0.005F) samples.flat.push_back(deviation);
            if (is_clear || deviation > kMissing) continue;
            squares += static_cast<double>(deviation) * static_cast<double>(deviation);
            covered += 1;
        }
    }
    const double misfit = covered > 0 ? squares / covered : 0;
    return {samples.noise(std::sqrt(misfit)), misfit};
}

}  // namespace grainfield::tracking
