#pragma once

#include "simulate/field/integrators/field_engine.h"
#include "simulate/field/kernels/line_sweep.h"

namespace grainfield::simulate {

/// The scheme as published (`castillo2019`): ψ by Crank–Nicolson in Fourier space, ρ by
/// Peaceman–Rachford ADI with half of the noise in each half step and D at the beginning of the
/// step,
///
///   (1 + X) ρ* = (1 − Y) ρ + w/2,   (1 + Y) ρ' = (1 − X) ρ* + w/2,   X = −(dt/2) ∂x D ∂x.
///
/// Kept as the reference for comparison: for constant D the spectrum is low by 1/(1 + a_x a_y),
/// a_i = dt D k_i²/2, and with D(ψ) it is not stable at large steps. One dimension: Crank–Nicolson.
template <class Real>
class PaperIntegrator : public FieldEngine<Real> {
 public:
    PaperIntegrator(const FieldSetup& setup, int threads);

 protected:
    using Array = typename FieldEngine<Real>::Array;
    void step(Team& team) override;

 private:
    void kick_rows(int replica, int first, int last);
    void explicit_rows(const Array& rho, int first, int last, Real h_x, Real h_y);

    Array kick_, next_;
    LineSweep<Real> sweep_;
};

extern template class PaperIntegrator<float>;
extern template class PaperIntegrator<double>;

}  // namespace grainfield::simulate
