#include "tracking/calibrate/background.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Dense>

namespace grainfield::tracking {
namespace {

constexpr int kTilesPerSide = 14;
constexpr int kEnvelopeDegree = 3;
constexpr int kClearDegree = 5;
constexpr double kClearTransmission = 0.9;
/// Tiles of which less is visible say nothing.
constexpr double kLeastOfTile = 0.25;

int term_count(int degree) {
    return (degree + 1) * (degree + 2) / 2;
}

/// All monomials X^i Y^j with i + j ≤ degree.
void monomials(int degree, double x, double y, double* out) {
    double power_x = 1;
    for (int i = 0; i <= degree; ++i) {
        double term = power_x;
        for (int j = 0; i + j <= degree; ++j) {
            *out++ = term;
            term *= y;
        }
        power_x *= x;
    }
}

struct Tile {
    int x0, y0, x1, y1;
};

std::vector<Tile> tiles_of(int width, int height, int per_side) {
    std::vector<Tile> tiles;
    for (int iy = 0; iy < per_side; ++iy) {
        for (int ix = 0; ix < per_side; ++ix) {
            const Tile t{width * ix / per_side, height * iy / per_side, width * (ix + 1) / per_side,
                         height * (iy + 1) / per_side};
            if (t.x1 > t.x0 && t.y1 > t.y0) tiles.push_back(t);
        }
    }
    return tiles;
}

float percentile(std::vector<float>& values, double fraction) {
    const auto n = static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + n, values.end());
    return values[static_cast<std::size_t>(n)];
}

BackgroundSurface uniform_if_flat(const BackgroundSurface& surface, int width, int height,
                                  double tolerance) {
    double low = surface(0, 0);
    double high = low;
    double sum = 0;
    int count = 0;
    for (int iy = 0; iy <= 16; ++iy) {
        for (int ix = 0; ix <= 16; ++ix) {
            const double b = surface((width - 1) * ix / 16.0, (height - 1) * iy / 16.0);
            low = std::min(low, b);
            high = std::max(high, b);
            sum += b;
            ++count;
        }
    }
    const double mean = sum / count;
    return high - low <= tolerance ? BackgroundSurface(mean) : surface;
}

/// (fall of the misfit per term) / (misfit of the surface per degree of freedom).
double f_ratio(const BackgroundSurface& surface, const BackgroundSurface& level,
               const std::vector<BackgroundSurface::Sample>& samples) {
    double with = 0;
    double without = 0;
    for (const auto& s : samples) {
        with += s.weight * std::pow(s.value - surface(s.x, s.y), 2);
        without += s.weight * std::pow(s.value - level(s.x, s.y), 2);
    }
    const int terms = surface.terms() - 1;
    const double freedom = static_cast<double>(samples.size()) - surface.terms();
    if (terms <= 0 || freedom <= 0) return 0;
    return (without - with) / terms / (with / freedom + 1e-12);
}

}  // namespace

BackgroundSurface::BackgroundSurface(int width, int height, int degree,
                                     std::vector<double> coefficients)
    : degree_(degree),
      scale_x_(2.0 / std::max(1, width - 1)),
      scale_y_(2.0 / std::max(1, height - 1)),
      centre_x_((width - 1) / 2.0),
      centre_y_((height - 1) / 2.0),
      coefficients_(std::move(coefficients)) {}

double BackgroundSurface::operator()(double x, double y) const {
    const double sx = (x - centre_x_) * scale_x_;
    const double sy = (y - centre_y_) * scale_y_;
    double sum = 0;
    double power_x = 1;
    std::size_t n = 0;
    for (int i = 0; i <= degree_; ++i) {
        double term = power_x;
        for (int j = 0; i + j <= degree_; ++j) {
            sum += coefficients_[n++] * term;
            term *= sy;
        }
        power_x *= sx;
    }
    return sum;
}

BackgroundSurface BackgroundSurface::negated() const {
    BackgroundSurface result = *this;
    for (double& c : result.coefficients_) c = -c;
    return result;
}

BackgroundSurface BackgroundSurface::towards(double level, double share) const {
    BackgroundSurface result = *this;
    for (double& c : result.coefficients_) c *= 1 - share;
    result.coefficients_[0] += share * level;
    return result;
}

BackgroundSurface BackgroundSurface::shifted(int x, int y) const {
    BackgroundSurface result = *this;
    result.centre_x_ -= x;
    result.centre_y_ -= y;
    return result;
}

void BackgroundSurface::row(int y, int width, float* out) const {
    if (is_uniform()) {
        std::fill(out, out + width, static_cast<float>(coefficients_[0]));
        return;
    }
    // At fixed y the surface is a polynomial in X alone.
    std::vector<double> in_x(static_cast<std::size_t>(degree_) + 1, 0.0);
    const double sy = (y - centre_y_) * scale_y_;
    std::size_t n = 0;
    for (int i = 0; i <= degree_; ++i) {
        double term = 1;
        for (int j = 0; i + j <= degree_; ++j) {
            in_x[static_cast<std::size_t>(i)] += coefficients_[n++] * term;
            term *= sy;
        }
    }
    // Power by power, so that it goes in vectors; single precision rounds to 1e-6 of the level.
    const auto scale = static_cast<float>(scale_x_);
    const auto begin = static_cast<float>(-centre_x_ * scale_x_);
    std::fill(out, out + width, static_cast<float>(in_x.back()));
    for (std::size_t i = in_x.size() - 1; i-- > 0;) {
        const auto term = static_cast<float>(in_x[i]);
#pragma omp simd
        for (int x = 0; x < width; ++x) {
            out[x] = out[x] * (begin + scale * static_cast<float>(x)) + term;
        }
    }
}

BackgroundSurface BackgroundSurface::fit(int width, int height, int degree,
                                         const std::vector<Sample>& samples) {
    for (; degree > 0; --degree) {
        const int terms = term_count(degree);
        if (static_cast<int>(samples.size()) < 3 * terms) continue;
        BackgroundSurface shape(width, height, degree,
                                std::vector<double>(static_cast<std::size_t>(terms), 0.0));
        Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(terms, terms);
        Eigen::VectorXd right = Eigen::VectorXd::Zero(terms);
        Eigen::VectorXd m(terms);
        for (const Sample& s : samples) {
            monomials(degree, (s.x - shape.centre_x_) * shape.scale_x_,
                      (s.y - shape.centre_y_) * shape.scale_y_, m.data());
            normal.selfadjointView<Eigen::Lower>().rankUpdate(m, s.weight);
            right += s.weight * s.value * m;
        }
        const Eigen::MatrixXd full = normal.selfadjointView<Eigen::Lower>();
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum(full);
        if (spectrum.eigenvalues()(0) < 1e-7 * spectrum.eigenvalues()(terms - 1)) continue;
        const Eigen::VectorXd c = full.ldlt().solve(right);
        shape.coefficients_.assign(c.data(), c.data() + terms);
        return shape;
    }
    double sum = 0;
    double weight = 0;
    for (const Sample& s : samples) {
        sum += s.weight * s.value;
        weight += s.weight;
    }
    return BackgroundSurface(weight > 0 ? sum / weight : 0.0);
}

BackgroundSurface upper_envelope(const Image& counts, double contrast, double uniform_tolerance,
                                 const VisiblePixels& visible) {
    std::vector<BackgroundSurface::Sample> samples;
    std::vector<float> values;
    for (const Tile& t : tiles_of(counts.width(), counts.height(), kTilesPerSide)) {
        values.clear();
        for (int y = t.y0; y < t.y1; ++y) {
            for (int x = t.x0; x < t.x1; ++x) {
                if (visible(x, y)) values.push_back(counts(x, y));
            }
        }
        const double all = static_cast<double>(t.x1 - t.x0) * (t.y1 - t.y0);
        if (static_cast<double>(values.size()) < kLeastOfTile * all) continue;
        samples.push_back({(t.x0 + t.x1 - 1) / 2.0, (t.y0 + t.y1 - 1) / 2.0,
                           static_cast<double>(percentile(values, 0.98)), 1.0});
    }
    BackgroundSurface surface =
        BackgroundSurface::fit(counts.width(), counts.height(), kEnvelopeDegree, samples);
    for (int iteration = 0; iteration < 20; ++iteration) {
        for (auto& s : samples) {
            // Tiles below the surface by more than 2 % of the contrast hold no clear pixel.
            const double below = (surface(s.x, s.y) - s.value) / (0.02 * contrast + 1e-12);
            s.weight = below <= 0 ? 1.0 : 1 / (1 + below * below);
        }
        surface = BackgroundSurface::fit(counts.width(), counts.height(), kEnvelopeDegree, samples);
    }
    return uniform_if_flat(surface, counts.width(), counts.height(), uniform_tolerance * contrast);
}

BackgroundSurface background_between_spheres(const Image& counts, const PaddedImage& transmission,
                                             double dark_level, const BackgroundSurface& previous,
                                             double contrast, double uniform_tolerance) {
    std::vector<BackgroundSurface::Sample> samples;
    const int tiles_per_side = std::clamp(std::min(counts.width(), counts.height()) / 24, 8, 48);
    for (const Tile& tile : tiles_of(counts.width(), counts.height(), tiles_per_side)) {
        BackgroundSurface::Sample sample{0, 0, 0, 0};
        for (int y = tile.y0; y < tile.y1; ++y) {
            for (int x = tile.x0; x < tile.x1; ++x) {
                const auto t = static_cast<double>(transmission(x, y));
                if (t < kClearTransmission) continue;
                sample.x += t * t * x;
                sample.y += t * t * y;
                sample.value += t * (static_cast<double>(counts(x, y)) - dark_level * (1 - t));
                sample.weight += t * t;
            }
        }
        if (sample.weight < 8) continue;
        sample.x /= sample.weight;
        sample.y /= sample.weight;
        sample.value /= sample.weight;
        samples.push_back(sample);
    }
    if (samples.size() < 3 * static_cast<std::size_t>(term_count(1))) return previous;
    auto surface = BackgroundSurface::fit(counts.width(), counts.height(), kClearDegree, samples);
    auto level = BackgroundSurface::fit(counts.width(), counts.height(), 0, samples);
    if (f_ratio(surface, level, samples) < 3) return level;
    return uniform_if_flat(surface, counts.width(), counts.height(), uniform_tolerance * contrast);
}

}  // namespace grainfield::tracking
