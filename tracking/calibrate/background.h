#pragma once

#include <vector>

#include "core/frame.h"
#include "tracking/model/padded_image.h"
#include "tracking/model/visible_pixels.h"

namespace grainfield::tracking {

/// The image without spheres: a polynomial in x and y of total degree `degree`,
///   B(x, y) = Σ_{i+j ≤ degree} c_ij X^i Y^j,   X, Y = pixel coordinates scaled to [−1, 1].
class BackgroundSurface {
 public:
    BackgroundSurface() = default;
    /// A uniform background.
    explicit BackgroundSurface(double level) : coefficients_{level} {}
    BackgroundSurface(int width, int height, int degree, std::vector<double> coefficients);

    double operator()(double x, double y) const;
    int terms() const { return static_cast<int>(coefficients_.size()); }
    bool is_uniform() const { return coefficients_.size() <= 1; }
    BackgroundSurface negated() const;
    /// (1 − share) B + share · level.
    BackgroundSurface towards(double level, double share) const;
    /// The surface seen by a part of the image that begins at pixel (x, y).
    BackgroundSurface shifted(int x, int y) const;
    /// One row of the surface, for x = 0 … width−1.
    void row(int y, int width, float* out) const;

    /// Least squares on samples (x, y, value) with weights; falls back to a lower degree when the
    /// samples do not determine the surface.
    struct Sample {
        double x, y, value, weight;
    };
    static BackgroundSurface fit(int width, int height, int degree,
                                 const std::vector<Sample>& samples);

 private:
    int degree_ = 0;
    double scale_x_ = 1, scale_y_ = 1, centre_x_ = 0, centre_y_ = 0;
    std::vector<double> coefficients_{0.0};
};

/// The light that reaches the camera between the spheres, without knowing where they are: the upper
/// envelope of bright percentiles of tiles. Tiles without any clear pixel (dense crystal) lie below
/// the surface and lose their weight in the iteration. `contrast` [counts] is the scale of what
/// counts as below; uniform if it varies by less than `uniform_tolerance` of it.
BackgroundSurface upper_envelope(const Image& counts, double contrast, double uniform_tolerance,
                                 const VisiblePixels& visible = {});

/// Refines B with the fitted scene: every pixel with transmission T above 0.9 gives B an estimate
/// [I − I_dark (1 − T)]/T of weight T²; tiles of them are fitted by a polynomial. Uniform if the
/// surface varies by less than `uniform_tolerance` of the contrast or explains the tiles no better
/// than chance (F ratio below 3). `previous` comes back when too few pixels are clear.
BackgroundSurface background_between_spheres(const Image& counts, const PaddedImage& transmission,
                                             double dark_level, const BackgroundSurface& previous,
                                             double contrast, double uniform_tolerance);

}  // namespace grainfield::tracking
