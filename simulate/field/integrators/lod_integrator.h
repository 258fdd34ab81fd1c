#pragma once

#include <cstdint>
#include <memory>

#include "simulate/field/integrators/field_engine.h"
#include "simulate/field/kernels/line_sweep.h"

namespace grainfield::simulate {

/// Locally one-dimensional Crank–Nicolson with the diffusivity averaged over the step, the default:
/// per direction, in alternating order,
///
///   (1 + A_i/2) q = ρ + w_i/2,   ρ ← 2q − ρ,   A_i = −dt ∂_i D̄ ∂_i,   D̄ = (D_n + D_{n+1})/2,
///   w_i = sqrt(C1 dt/dx^d)/dx · (difference of face noises along i).
///
/// For constant D each direction leaves S = C1/(2 D0) exactly, at any dt; each sweep is a
/// contraction, so that no step is too long for stability. Bias with D(ψ) at dt = 0.5: about 0.4 %
/// (docs/field/schemes.md).
template <class Real>
class LodIntegrator : public FieldEngine<Real> {
 public:
    LodIntegrator(const FieldSetup& setup, int threads);

 protected:
    void step(Team& team) override;

 private:
    LineSweep<Real> sweep_;
};

extern template class LodIntegrator<float>;
extern template class LodIntegrator<double>;

}  // namespace grainfield::simulate
