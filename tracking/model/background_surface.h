#pragma once

#include <vector>

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
    /// Of a polynomial of that degree: (degree + 1)(degree + 2)/2.
    static int terms_of(int degree) { return (degree + 1) * (degree + 2) / 2; }
    int terms() const { return static_cast<int>(coefficients_.size()); }
    int degree() const { return degree_; }
    /// c_ij, i slowest, as the constructor takes them.
    const std::vector<double>& coefficients() const { return coefficients_; }
    bool is_uniform() const { return coefficients_.size() <= 1; }
    BackgroundSurface negated() const;
    /// (1 − share) B + share · level.
    BackgroundSurface towards(double level, double share) const;
    /// The surface seen by a part of the image that begins at pixel (x, y).
    BackgroundSurface shifted(int x, int y) const;
    /// The surface in pixels where this one counts blocks of factor × factor of them.
    BackgroundSurface in_pixels(int factor) const;
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

}  // namespace grainfield::tracking
