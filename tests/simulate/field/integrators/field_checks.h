#pragma once

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "core/support/fourier.h"
#include "simulate/field/integrators/integrator_choice.h"

namespace grainfield::testing {

inline simulate::FieldSetup plane(int nx, int ny, simulate::FieldScheme scheme, double dt) {
    simulate::FieldSetup setup;
    setup.lattice = {2, nx, ny, 0.65};
    setup.scheme = scheme;
    setup.dt = dt;
    setup.k_cut = 1e9;
    return setup;
}

inline simulate::FieldSetup line(int nx, simulate::FieldScheme scheme, double dt) {
    simulate::FieldSetup setup = plane(nx, 1, scheme, dt);
    setup.lattice = {1, nx, 1, 0.25};
    setup.model.b = 2;
    return setup;
}

/// S at each mode of the lattice, summed over samples, and means over rings of k.
class Spectrum {
 public:
    explicit Spectrum(const simulate::Lattice& lattice)
        : lattice_(lattice),
          transform_(lattice.nx, lattice.ny),
          sum_(transform_.complex().size(), 0) {}

    void add(const DensityField& field) {
        std::copy(field.value.begin(), field.value.end(), transform_.real().begin());
        transform_.forward();
        const double scale = lattice_.cell_volume() * lattice_.cell_volume() / lattice_.volume();
        for (std::size_t m = 0; m < sum_.size(); ++m) {
            sum_[m] += scale * std::norm(transform_.complex()[m]);
        }
        ++count_;
    }

    /// Mean over the modes with low ≤ |k| < high.
    double mean(double low, double high, double* k = nullptr) const {
        double sum = 0, weight = 0, wave = 0;
        const int columns = lattice_.nx / 2 + 1;
        for (int y = 0; y < lattice_.ny; ++y) {
            for (int x = 0; x < columns; ++x) {
                const double size = wavenumber(x, y);
                if ((x == 0 && y == 0) || size < low || size >= high) continue;
                const double w = x == 0 || 2 * x == lattice_.nx ? 1 : 2;
                sum += w * sum_[static_cast<std::size_t>(y * columns + x)];
                weight += w;
                wave += w * size;
            }
        }
        if (k != nullptr) *k = wave / weight;
        return sum / weight / count_;
    }
    double at(int x, int y) const {
        return sum_[static_cast<std::size_t>(y * (lattice_.nx / 2 + 1) + x)] / count_;
    }
    double wavenumber(int x, int y) const {
        const int sy = 2 * y > lattice_.ny ? y - lattice_.ny : y;
        return 2 * std::numbers::pi / lattice_.spacing *
               std::hypot(static_cast<double>(x) / lattice_.nx,
                          static_cast<double>(sy) / lattice_.ny);
    }
    int count() const { return count_; }

 private:
    simulate::Lattice lattice_;
    RealFourier2D<double> transform_;
    std::vector<double> sum_;
    int count_ = 0;
};

}  // namespace grainfield::testing
