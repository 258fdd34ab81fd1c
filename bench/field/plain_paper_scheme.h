#pragma once

#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include <fftw3.h>

namespace grainfield::bench {

/// The published scheme as one would write it down: double, std::normal_distribution, FFTW there
/// and back for ψ, Thomas with Sherman–Morrison for the rings. For comparison only.
class PlainPaperScheme {
 public:
    PlainPaperScheme(int n, double dx, double dt, double nu)
        : n_(n),
          dx_(dx),
          dt_(dt),
          nu_(nu),
          psi_(size()),
          rho_(size()),
          d_(size(), 1),
          rhs_(size()),
          kick_(size()),
          fx_(size()),
          fy_(size()),
          modes_(static_cast<std::size_t>(n) * static_cast<std::size_t>(n / 2 + 1)) {
        auto* modes = reinterpret_cast<fftw_complex*>(modes_.data());
        forward_ = fftw_plan_dft_r2c_2d(n, n, psi_.data(), modes, FFTW_ESTIMATE);
        backward_ = fftw_plan_dft_c2r_2d(n, n, modes, psi_.data(), FFTW_ESTIMATE);
    }
    ~PlainPaperScheme() {
        fftw_destroy_plan(forward_);
        fftw_destroy_plan(backward_);
    }
    PlainPaperScheme(const PlainPaperScheme&) = delete;
    PlainPaperScheme& operator=(const PlainPaperScheme&) = delete;

    void step() {
        for (std::size_t i = 0; i < size(); ++i) d_[i] = std::exp(-psi_[i] * psi_[i]);
        const double s = std::sqrt(dt_) / dx_ / dx_;
        for (std::size_t i = 0; i < size(); ++i) {
            fx_[i] = s * normal_(random_);
            fy_[i] = s * normal_(random_);
        }
        for (int y = 0; y < n_; ++y) {
            for (int x = 0; x < n_; ++x) {
                kick_[at(x, y)] =
                    0.5 * (fx_[at(x, y)] - fx_[at(x - 1, y)] + fy_[at(x, y)] - fy_[at(x, y - 1)]);
            }
        }
        half_step(0, 1);
        half_step(1, 0);
        order_step();
    }

 private:
    std::size_t size() const { return static_cast<std::size_t>(n_) * static_cast<std::size_t>(n_); }
    std::size_t at(int x, int y) const {
        return static_cast<std::size_t>((y + n_) % n_ * n_ + (x + n_) % n_);
    }

    // Implicit along one direction, explicit along the other (ex, ey).
    void half_step(int ex, int ey) {
        const double h = dt_ / (4 * dx_ * dx_);
        for (int y = 0; y < n_; ++y) {
            for (int x = 0; x < n_; ++x) {
                const std::size_t i = at(x, y), p = at(x + ex, y + ey), m = at(x - ex, y - ey);
                rhs_[i] = rho_[i] + kick_[i] +
                          h * ((d_[i] + d_[p]) * (rho_[p] - rho_[i]) -
                               (d_[i] + d_[m]) * (rho_[i] - rho_[m]));
            }
        }
        for (int line = 0; line < n_; ++line) ring(line, ey != 0, h);
    }

    void ring(int line, bool along_x, double h) {
        const auto cell = [&](int i) { return along_x ? at(i, line) : at(line, i); };
        const auto n = static_cast<std::size_t>(n_);
        a_.resize(n);
        c_.resize(n);
        q_.resize(n);
        u_.assign(n, 0);
        std::vector<double> b(n);
        for (int i = 0; i < n_; ++i) {
            const auto k = static_cast<std::size_t>(i);
            a_[k] = -h * (d_[cell(i)] + d_[cell(i - 1)]);
            c_[k] = -h * (d_[cell(i)] + d_[cell(i + 1)]);
            b[k] = 1 - a_[k] - c_[k];
            q_[k] = rhs_[cell(i)];
        }
        const double corner = a_[0], gamma = -b[0];
        b[0] -= gamma;
        b[n - 1] -= corner * corner / gamma;
        u_[0] = gamma;
        u_[n - 1] = corner;
        std::vector<double> cc(n);
        cc[0] = c_[0] / b[0];
        q_[0] /= b[0];
        u_[0] /= b[0];
        for (std::size_t i = 1; i < n; ++i) {
            const double p = 1 / (b[i] - a_[i] * cc[i - 1]);
            cc[i] = c_[i] * p;
            q_[i] = (q_[i] - a_[i] * q_[i - 1]) * p;
            u_[i] = (u_[i] - a_[i] * u_[i - 1]) * p;
        }
        for (std::size_t i = n - 1; i-- > 0;) {
            q_[i] -= cc[i] * q_[i + 1];
            u_[i] -= cc[i] * u_[i + 1];
        }
        const double f =
            (q_[0] + corner / gamma * q_[n - 1]) / (1 + u_[0] + corner / gamma * u_[n - 1]);
        for (int i = 0; i < n_; ++i) {
            rho_[cell(i)] = q_[static_cast<std::size_t>(i)] - f * u_[static_cast<std::size_t>(i)];
        }
    }

    void order_step() {
        const double s = std::sqrt(dt_) / dx_;
        fftw_execute(forward_);
        std::vector<std::complex<double>> kept = modes_;
        for (double& value : psi_) value = s * normal_(random_);
        fftw_execute(forward_);
        const double dk = 2 * 3.14159265358979324 / (n_ * dx_);
        for (int y = 0; y < n_; ++y) {
            for (int x = 0; x <= n_ / 2; ++x) {
                const double ky = dk * (y <= n_ / 2 ? y : y - n_), kx = dk * x;
                const double k2 = kx * kx + ky * ky, g = (nu_ + k2 * k2) * dt_ / 2;
                const auto i = static_cast<std::size_t>(y * (n_ / 2 + 1) + x);
                modes_[i] = ((1 - g) * kept[i] + modes_[i]) / (1 + g) / static_cast<double>(size());
            }
        }
        fftw_execute(backward_);
    }

    int n_;
    double dx_, dt_, nu_;
    std::vector<double> psi_, rho_, d_, rhs_, kick_, fx_, fy_, a_, c_, q_, u_;
    std::vector<std::complex<double>> modes_;
    fftw_plan forward_, backward_;
    std::mt19937_64 random_{1};
    std::normal_distribution<double> normal_;
};

}  // namespace grainfield::bench
