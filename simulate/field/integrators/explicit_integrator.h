#pragma once

#include "simulate/field/integrators/field_engine.h"

namespace grainfield::simulate {

/// Explicit Leimkuhler–Matthews [leimkuhler2013]:
///
///   z = ρ + w/2,   ρ ← ρ + dt ∇·(D̄∇z) + w,   sample z,
///
/// one pass over the lattice. For constant D the spectrum of z is exactly flat, C1/(2 D0), at any
/// stable dt: dt < dx²/(2 d D0), d the dimension. One noise a face and step, drawn again where two
/// threads meet. density() is z.
template <class Real>
class ExplicitIntegrator : public FieldEngine<Real> {
 public:
    /// Throws OptionError at or above the bound, naming it.
    ExplicitIntegrator(const FieldSetup& setup, int threads);

    DensityField density(int replica) const override;

    /// dx²/(2 d D0), infinite for D0 = 0.
    static double largest_step(const Lattice& lattice, double d0);

 protected:
    using Array = typename FieldEngine<Real>::Array;
    void step(Team& team) override;

 private:
    void advance_rows(int replica, int first, int last);

    Array next_;
};

extern template class ExplicitIntegrator<float>;
extern template class ExplicitIntegrator<double>;

}  // namespace grainfield::simulate
