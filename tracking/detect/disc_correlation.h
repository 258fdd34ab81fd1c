#pragma once

#include <complex>
#include <memory>
#include <vector>

#include "core/fourier.h"
#include "core/frame.h"
#include "tracking/disc_profile.h"

namespace grainfield::tracking {

/// Correlations of images with powers of one disc profile, by FFT, for one image size.
///
/// Both detection maps are sums of correlations A ⊗ P^n, (A ⊗ K)(x) = Σ_y A(y) K(y − x), with the
/// image taken as zero outside its frame (zero padding by the reach of the disc). O(n log n); the
/// transforms of the kernels are computed once.
class DiscCorrelation {
 public:
    DiscCorrelation(int width, int height, const DiscProfile& disc);

    /// Shattuck's normalised misfit of a single disc at every pixel (`shattuck_chitrack`):
    ///   χ²(x) = Σ_y P (I − P)² / Σ_y P³ = [I² ⊗ P − 2 I ⊗ P² + 1 ⊗ P³] / (1 ⊗ P³),
    /// 0 for a perfect disc, 1 on an empty background. The denominator handles the borders.
    Image chi_squared(const Image& darkness);

    /// By how much the sum of squared residuals falls if one more disc is placed at each pixel, all
    /// others fixed. With residual r = I − (1 − T) and transmission T of the discs already placed,
    ///   G(x) = Σ_y [r² − (r − T P)²] = 2 (r T) ⊗ P − T² ⊗ P².
    /// G/σ² is twice the log-likelihood ratio for white noise of variance σ². With no disc placed
    /// (T = 1, r = I) it is the matched filter.
    Image gain(const Image& darkness, const Image& transmission);

    /// G of an isolated disc on a clear background: Σ P².
    double full_gain() const { return full_gain_; }

 private:
    using Spectrum = std::vector<std::complex<float>>;
    void load(const Image& image, const Image* factor);
    Spectrum kernel_spectrum(const DiscProfile& disc, int power);
    Image crop();

    int width_;
    int height_;
    double full_gain_ = 0;
    RealFourier2D<float> fourier_;
    Spectrum kernel_[3];
    Spectrum sum_;
    Image norm_;  ///< 1 ⊗ P³
};

}  // namespace grainfield::tracking
