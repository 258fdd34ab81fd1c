#include "simulate/field/model/order_spectrum.h"

#include <cmath>
#include <numbers>

namespace grainfield::simulate {

namespace {

double wavenumber(int n, int cells, double spacing) {
    return 2 * std::numbers::pi * n / (cells * spacing);
}

double variance(const ModelOptions& model, const Lattice& lattice, double k2) {
    const double g = decay_rate(model, k2);
    return g > 0 ? model.c2 / (2 * g * lattice.volume()) : 0;
}

// How many of the four (or two, or one) sign combinations of (kx, ky) are different modes.
int copies(int n, int cells) {
    return n == 0 || 2 * n == cells ? 1 : 2;
}

}  // namespace

double decay_rate(const ModelOptions& model, double k2) {
    double power = 1;
    for (int i = 0; i < model.b / 2; ++i) power *= k2;
    return model.nu + model.mu * power;
}

double order_variance(const Lattice& lattice, const ModelOptions& model) {
    double sum = 0;
    for (int x = 0; x <= lattice.nx / 2; ++x) {
        const double kx = wavenumber(x, lattice.nx, lattice.spacing);
        double column = 0;
        for (int y = 0; y <= lattice.ny / 2; ++y) {
            const double ky = wavenumber(y, lattice.ny, lattice.spacing);
            column += copies(y, lattice.ny) * variance(model, lattice, kx * kx + ky * ky);
        }
        sum += copies(x, lattice.nx) * column;
    }
    return sum;
}

OrderSpectrum::OrderSpectrum(const Lattice& lattice, const ModelOptions& model, double dt,
                             OrderScheme scheme, double k_cut)
    : lattice_(lattice) {
    double kept_variance = 0;
    for (int x = 0; x <= lattice.nx / 2; ++x) {
        const double kx = wavenumber(x, lattice.nx, lattice.spacing);
        if (kx > k_cut && x > 0) break;
        start_.push_back(loss_.size());
        int rows = -1;
        for (int y = 0; y <= lattice.ny / 2; ++y) {
            const double ky = wavenumber(y, lattice.ny, lattice.spacing);
            const double k2 = kx * kx + ky * ky;
            if (k2 > k_cut * k_cut && k2 > 0) break;
            const double g = decay_rate(model, k2);
            const double sigma2 = variance(model, lattice, k2);
            if (g == 0) diffuses_ = true;
            const double half = g * dt / 2;
            const double kick = model.c2 * dt / lattice.volume();
            const bool exact = scheme == OrderScheme::exact;
            loss_.push_back(exact ? -std::expm1(-g * dt) : g * dt / (1 + half));
            amplitude_.push_back(!exact  ? std::sqrt(kick) / (1 + half)
                                 : g > 0 ? std::sqrt(-sigma2 * std::expm1(-2 * g * dt))
                                         : std::sqrt(kick));
            stationary_.push_back(std::sqrt(sigma2));
            const int same = copies(x, lattice.nx) * copies(y, lattice.ny);
            kept_ += static_cast<std::size_t>(same);
            kept_variance += same * sigma2;
            rows = y;
        }
        rows_.push_back(rows);
    }
    missing_variance_ = std::max(0.0, order_variance(lattice, model) - kept_variance);
    if (kept_ == all()) missing_variance_ = 0;
}

}  // namespace grainfield::simulate
