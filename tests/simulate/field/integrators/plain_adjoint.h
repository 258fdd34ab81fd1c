#pragma once

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <span>
#include <vector>

namespace grainfield::testing {

/// S(k) of a scheme on one path of ψ without any noise of the density, for schemes whose step is
/// linear, ρ ← Mρ + Nw: the transposed step, plain loops in double precision. Time is reversed,
/// which the law of the path does not notice (docs/field/schemes.md).
///
///   S(k) = C1 dt Σ_n ‖∇Nᵀφ_n‖² (+ the part of the noise that is sampled at once), φ ← Mᵀφ.
class PlainAdjoint {
 public:
    using Field = std::vector<std::complex<double>>;

    PlainAdjoint(int cells, double spacing, int n_x, int n_y)
        : cells_(cells),
          spacing_(spacing),
          phi_(static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells)) {
        const double size = 1 / (cells * spacing);
        for (int y = 0; y < cells; ++y) {
            for (int x = 0; x < cells; ++x) {
                phi_[at(y, x)] = std::polar(
                    size, 2 * std::numbers::pi *
                              (static_cast<double>(n_x) * x + static_cast<double>(n_y) * y) /
                              cells);
            }
        }
    }

    /// Leimkuhler–Matthews: ρ ← ρ + dt ∇·(D∇(ρ + w/2)) + w, sample ρ + w/2.
    void leimkuhler_matthews(std::span<const double> d, double dt, double c1) {
        if (sum_ == 0) sum_ = c1 * dt * square_of_gradient(phi_) / 4;
        const Field flow = diffusion(d, phi_, true, true);
        Field noise = phi_;
        for (std::size_t i = 0; i < phi_.size(); ++i) {
            noise[i] += dt / 2 * flow[i];
            phi_[i] += dt * flow[i];
        }
        sum_ += c1 * dt * square_of_gradient(noise);
    }

    /// As published: (1 + A_x/2)ρ* = (1 − A_y/2)ρ + w/2, (1 + A_y/2)ρ = (1 − A_x/2)ρ* + w/2.
    void peaceman_rachford(std::span<const double> d, double dt, double c1) {
        const Field one = solve(d, phi_, dt / 2, false);
        const Field two = solve(d, forward(d, one, dt / 2, true), dt / 2, true);
        Field noise(one.size());
        for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = (one[i] + two[i]) / 2.0;
        sum_ += c1 * dt * square_of_gradient(noise);
        phi_ = forward(d, two, dt / 2, false);
    }

    double sum() const { return sum_; }

 private:
    std::size_t at(int y, int x) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(cells_) +
               static_cast<std::size_t>(x);
    }
    int wrapped(int i) const { return (i + cells_) % cells_; }

    /// The face between a cell and its next one along x, or along y.
    double face(std::span<const double> d, int y, int x, bool along_x) const {
        const std::size_t next = along_x ? at(y, wrapped(x + 1)) : at(wrapped(y + 1), x);
        return (d[at(y, x)] + d[next]) / 2;
    }

    Field diffusion(std::span<const double> d, const Field& f, bool in_x, bool in_y) const {
        Field out(f.size());
        const double scale = 1 / (spacing_ * spacing_);
        for (const bool along_x : {true, false}) {
            if (!(along_x ? in_x : in_y)) continue;
            for (int y = 0; y < cells_; ++y) {
                for (int x = 0; x < cells_; ++x) {
                    const std::size_t here = at(y, x);
                    const std::size_t next =
                        along_x ? at(y, wrapped(x + 1)) : at(wrapped(y + 1), x);
                    const auto flow = scale * face(d, y, x, along_x) * (f[next] - f[here]);
                    out[here] += flow;
                    out[next] -= flow;
                }
            }
        }
        return out;
    }

    Field forward(std::span<const double> d, const Field& f, double h, bool along_x) const {
        Field out = diffusion(d, f, along_x, !along_x);
        for (std::size_t i = 0; i < f.size(); ++i) out[i] = f[i] + h * out[i];
        return out;
    }

    /// (1 + h A) u = f along every line, A = −∂D∂; the ring closed by Sherman–Morrison.
    Field solve(std::span<const double> d, const Field& f, double h, bool along_x) const {
        Field out(f.size());
        const auto n = static_cast<std::size_t>(cells_);
        const double scale = h / (spacing_ * spacing_);
        std::vector<double> face_of(n), pivot(n);
        Field u(n), v(n);
        for (int line = 0; line < cells_; ++line) {
            const auto cell = [&](int i) { return along_x ? at(line, i) : at(i, line); };
            for (int i = 0; i < cells_; ++i) {
                face_of[static_cast<std::size_t>(i)] =
                    scale * (along_x ? face(d, line, i, true) : face(d, i, line, false));
                u[static_cast<std::size_t>(i)] = f[cell(i)];
                v[static_cast<std::size_t>(i)] = 0;
            }
            // M = T + c e eᵀ with e = (1, 0 …, −1), c the face that closes the ring.
            const double c = face_of[n - 1];
            v[0] = 1;
            v[n - 1] = -1;
            for (std::size_t i = 0; i < n; ++i) {
                const double left = i > 0 ? face_of[i - 1] : 0;
                const double right = i + 1 < n ? face_of[i] : 0;
                pivot[i] = 1 + left + right;
                if (i == 0) continue;
                const double factor = left / pivot[i - 1];
                pivot[i] -= factor * left;
                u[i] += factor * u[i - 1];
                v[i] += factor * v[i - 1];
            }
            for (std::size_t i = n; i-- > 0;) {
                const double right = i + 1 < n ? face_of[i] : 0;
                const std::complex<double> u_next = i + 1 < n ? u[i + 1] : 0;
                const std::complex<double> v_next = i + 1 < n ? v[i + 1] : 0;
                u[i] = (u[i] + right * u_next) / pivot[i];
                v[i] = (v[i] + right * v_next) / pivot[i];
            }
            const auto correction = c * (u[0] - u[n - 1]) / (1.0 + c * (v[0] - v[n - 1]));
            for (std::size_t i = 0; i < n; ++i) {
                out[cell(static_cast<int>(i))] = u[i] - correction * v[i];
            }
        }
        return out;
    }

    /// ‖∇f‖²
    double square_of_gradient(const Field& f) const {
        double sum = 0;
        for (int y = 0; y < cells_; ++y) {
            for (int x = 0; x < cells_; ++x) {
                sum += std::norm(f[at(y, wrapped(x + 1))] - f[at(y, x)]) +
                       std::norm(f[at(wrapped(y + 1), x)] - f[at(y, x)]);
            }
        }
        return sum;  // 1/spacing² of the gradient and the area of a cell cancel
    }

    int cells_;
    double spacing_;
    Field phi_;
    double sum_ = 0;
};

}  // namespace grainfield::testing
