#pragma once

#include <cstdint>
#include <vector>

#include "core/frame.h"
#include "simulate/noise.h"
#include "simulate/render/projection.h"
#include "simulate/render/render_options.h"

namespace grainfield::simulate {

/// Turns radiance into counts, as a lens and a CMOS sensor do (`emva1288`).
///
///   E   = [(1 − v) b ⊗ G_σ + v] · M              relative exposure of a pixel
///   e⁻  = Poisson(q E (1 + p)) + N(d, σ_r²),      q = level · full well
///   DN  = round(K e⁻ + offset), clipped to 0 … 2^bits − 1
///
/// b: radiance relative to the unobstructed backlight; G_σ: point spread, a Gaussian; v: stray
/// light; M: static map of panel falloff, gradient, vignetting and dust, 1 at its brightest; p, d:
/// fixed patterns of response (prnu) and dark level (dsnu), Gaussian and static; K: gain. Hence
///
///   var(DN) = K² (σ_r² + q E) + 1/12     away from saturation (photon transfer).
///
/// Electrons above full well are lost. Dead pixels read the offset, hot ones full scale. From 20
/// electrons on, the sum of Poisson and Gaussian is drawn from one normal number z as
/// μ + s z + (μ/6s²)(z² − 1), s² = μ + σ_r² (Cornish–Fisher: mean, variance and skewness exact up
/// to 1/μ); below, from the exact law. Noise depends on seed, frame and pixel only.
///
/// Dust sits on the sensor's side: it does not move with the camera.
class Camera {
 public:
    /// Throws OptionError (require_valid).
    Camera(const RenderOptions& options, const View& view, std::uint64_t seed, int threads);

    /// Pixels on every side of the frame that the blur reaches, and the number n of radiance pixels
    /// along one side of a camera pixel: n σ ≥ 2, n ≤ 8. The sum that replaces the blur's integral
    /// is then off by at most (1/12 n²) (g(t) − g(t − 1)) < 0.3 % of an edge's height, g the point
    /// spread along a line, and by nothing on the average over sub-pixel positions.
    int margin() const { return margin_; }
    int supersampling() const { return supersampling_; }
    /// The view in which radiance is wanted: `view` padded and refined.
    View radiance_view(const View& view) const;

    /// The blurred, illuminated image that the sensor sees: E, without the pattern of response.
    Image exposure(const Image& radiance) const;
    /// The counts of frame `index`.
    Frame develop(const Image& exposure, std::int64_t index) const;
    Frame photograph(const Image& radiance, std::int64_t index) const {
        return develop(exposure(radiance), index);
    }

    const Image& illumination() const { return map_; }  ///< M
    double gain() const { return gain_; }               ///< K [DN/e-]

    /// Expected counts where E is `exposure`, before rounding, and their variance [DN, DN²].
    double mean_counts(double exposure) const;
    double variance_counts(double exposure) const;

 private:
    struct Defect {
        std::size_t pixel;
        float value;
    };
    void develop_row(const Image& exposure, std::int64_t index, int y, Image& counts) const;

    RenderOptions options_;
    int threads_;
    int width_;
    int height_;
    int supersampling_ = 1;
    int margin_ = 0;
    double gain_ = 1;
    double sigma_ = 0;  // of the point spread [radiance px]
    Image map_;
    Image response_;  // 1 + p; empty if prnu is 0
    Image dark_;      // d [e-]; empty if dsnu is 0
    std::vector<Defect> defects_;
    std::uint64_t seed_;
    NoiseStream noise_;
};

}  // namespace grainfield::simulate
