#pragma once

#include <vector>

#include "core/frame.h"
#include "core/support/fourier.h"
#include "core/vec2.h"
#include "tracking/detect/residual_blocks.h"
#include "tracking/model/disc_profile.h"
#include "tracking/model/padded_image.h"
#include "tracking/model/visible_pixels.h"

namespace grainfield::tracking {

/// Correlations of images with powers of one disc profile, by FFT, for one image size.
///
/// Both detection maps are sums of correlations A ⊗ P^n, (A ⊗ K)(x) = Σ_y A(y) K(y − x), with the
/// image taken as zero outside its frame (zero padding by the reach of the disc). A candidate needs
/// to be known to a pixel or so, and refinement does the rest: images and kernels are averaged over
/// blocks of `factor()` pixels first, which saves the square of it. O(n log n); the transforms of
/// the kernels are computed once.
class DiscCorrelation {
 public:
    /// The largest blocks that leave seven of them to a diameter.
    static int suitable_factor(const DiscProfile& disc);

    DiscCorrelation(int width, int height, const DiscProfile& disc, int factor);

    int factor() const { return factor_; }
    /// Others count as those beyond the border.
    void set_visible(const VisiblePixels& visible);

    /// The place in the frame of a point of the maps.
    Vec2 in_frame(Vec2 in_map) const {
        const double centre = 0.5 * (factor_ - 1);
        return {in_map.x * factor_ + centre, in_map.y * factor_ + centre};
    }
    /// The other way round.
    Vec2 in_map(Vec2 in_frame) const {
        const double centre = 0.5 * (factor_ - 1);
        return {(in_frame.x - centre) / factor_, (in_frame.y - centre) / factor_};
    }

    /// Shattuck's normalised misfit of a single disc at every block (`shattuck_chitrack`):
    ///   χ²(x) = Σ_y P (I − P)² / Σ_y P³ = [I² ⊗ P − 2 I ⊗ P² + 1 ⊗ P³] / (1 ⊗ P³),
    /// 0 for a perfect disc, 1 on an empty background and where nothing is visible. The denominator
    /// handles the borders; `transmission` is 0 where nothing is visible.
    Image chi_squared(const PaddedImage& darkness, const PaddedImage& transmission);

    /// By how much the sum of squared residuals falls if one more disc is placed at each block, all
    /// others fixed. With residual r = I − (1 − T) and transmission T of the discs already placed,
    ///   G(x) = Σ_y [r² − (r − T P)²] = 2 (r T) ⊗ P − T² ⊗ P².
    /// G/σ² is twice the log-likelihood ratio for white noise of variance σ². With no disc placed
    /// (T = 1, r = I) it is the matched filter. Exact for factor 1; averaging over blocks costs a
    /// few percent of it at the edges.
    Image gain(const PaddedImage& darkness, const PaddedImage& transmission);

    /// The same where the blocks of the map lie in `places` or next to them, summed directly; zero
    /// elsewhere. Valid until the next call.
    const Image& gain_in(const std::vector<PixelBlock>& places, const PaddedImage& darkness,
                         const PaddedImage& transmission);
    /// Whether that is cheaper than the gain of all: they cover a fifth of the image at most.
    bool are_few(const std::vector<PixelBlock>& places) const;

    /// G of an isolated disc on a clear background: Σ P².
    double full_gain() const { return full_gain_; }

 private:
    struct Blocks {
        Image first, second;
    };
    int half_width(const DiscProfile& disc) const;
    std::vector<float> block_kernel(const DiscProfile& disc, int power) const;
    void add_gain(const PixelBlock& map_part, const PaddedImage& darkness,
                  const PaddedImage& transmission, Image& map) const;
    std::vector<float> kernel_spectrum(const DiscProfile& disc, int power);
    void transform(const Image& blocks);
    /// a ⊗ (scale_a P^pa) + b ⊗ (scale_b P^pb).
    Image correlate(const Blocks& blocks, float scale_first, float scale_second);

    int factor_;
    int pixels_x_, pixels_y_;
    int width_;   ///< blocks
    int height_;  ///< blocks
    double full_gain_ = 0;
    RealFourier2D<float> fourier_;
    int half_;                      ///< of the kernels [blocks]
    std::vector<float> taps_[2];    ///< P, P² summed over each block, 2 half + 1 a row
    std::vector<float> kernel_[3];  ///< real, since P is even; normalisation included
    std::vector<std::complex<float>> sum_;
    Image norm_;                     ///< 1 ⊗ P³
    Image in_part_;                  ///< gain_in(); empty before the first call
    std::vector<PixelBlock> parts_;  ///< of it, that are not zero
};

}  // namespace grainfield::tracking
