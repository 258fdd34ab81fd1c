#include "tracking/model/background_surface.h"

#include <algorithm>
#include <utility>

#include <Eigen/Dense>

namespace grainfield::tracking {
namespace {

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

BackgroundSurface BackgroundSurface::in_pixels(int factor) const {
    BackgroundSurface result = *this;
    for (double* centre : {&result.centre_x_, &result.centre_y_}) {
        *centre = *centre * factor + 0.5 * (factor - 1);
    }
    for (double* scale : {&result.scale_x_, &result.scale_y_}) *scale /= factor;
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
        const int terms = terms_of(degree);
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

}  // namespace grainfield::tracking
