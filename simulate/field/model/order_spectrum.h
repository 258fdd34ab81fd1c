#pragma once

#include <cstddef>
#include <vector>

#include "simulate/field/field_options.h"
#include "simulate/field/model/lattice.h"

namespace grainfield::simulate {

/// How the modes of ψ are carried through a time step.
enum class OrderScheme {
    exact,          ///< Ornstein–Uhlenbeck, exact for any step
    crank_nicolson  ///< as published: rings with factor → −1 where g dt ≫ 1
};

/// Rates and one-step coefficients of the Fourier modes of the order field,
///
///   ψ(r) = Σ_k c_k exp(ik·r),   dc_k/dt = −g_k c_k + ξ_k,   g_k = ν + μ|k|^b,
///   c_k ← c_k − λ_k c_k + β_k ζ,   ⟨ζζ*⟩ = 1,   λ = 1 − α,
///   exact:           α = e^{−g dt},  β² = σ_k² (1 − α²),  σ_k² = C2/(2 g_k L^d),
///   Crank–Nicolson:  α = (1 − g dt/2)/(1 + g dt/2),  β² = C2 dt/L^d / (1 + g dt/2)².
///
/// λ is kept, not α: in single precision α of a slow mode would be rounded to 1 and its variance
/// would be wrong. Both keep ⟨|c_k|²⟩ = σ_k² exactly (docs/field/schemes.md). A mode with g_k = 0
/// diffuses: α = 1, β² = C2 dt/L^d. Only modes with |k| ≤ k_cut are kept.
class OrderSpectrum {
 public:
    OrderSpectrum(const Lattice& lattice, const ModelOptions& model, double dt, OrderScheme scheme,
                  double k_cut);

    /// Columns kx = 0 … columns() − 1, each with ky = −rows(kx) … rows(kx).
    int columns() const { return static_cast<int>(rows_.size()); }
    int rows(int kx) const { return rows_[static_cast<std::size_t>(kx)]; }
    std::size_t kept() const { return kept_; }  ///< modes of both half planes
    std::size_t all() const { return lattice_.cells(); }

    /// λ per |ky| = 0 … rows(kx).
    const double* loss(int kx) const { return &loss_[start_[static_cast<std::size_t>(kx)]]; }
    const double* amplitude(int kx) const {
        return &amplitude_[start_[static_cast<std::size_t>(kx)]];
    }
    /// Stationary standard deviation sqrt(⟨|c_k|²⟩); 0 where there is none (g = 0).
    const double* stationary(int kx) const {
        return &stationary_[start_[static_cast<std::size_t>(kx)]];
    }

    /// Σ_k σ_k² over the modes that were left out: the variance that ψ misses.
    double missing_variance() const { return missing_variance_; }
    bool diffuses() const { return diffuses_; }

 private:
    Lattice lattice_;
    std::vector<int> rows_;
    std::vector<std::size_t> start_;
    std::vector<double> loss_, amplitude_, stationary_;
    std::size_t kept_ = 0;
    double missing_variance_ = 0;
    bool diffuses_ = false;
};

/// g_k = ν + μ k^b for even b, without pow.
double decay_rate(const ModelOptions& model, double k2);

/// Σ_k σ_k² over all modes of the lattice: ⟨ψ²⟩. Modes with g = 0 are left out.
double order_variance(const Lattice& lattice, const ModelOptions& model);

}  // namespace grainfield::simulate
