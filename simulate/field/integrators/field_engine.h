#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/support/team.h"
#include "simulate/field/integrators/field_integrator.h"
#include "simulate/field/kernels/aligned_vector.h"
#include "simulate/field/model/diffusivity.h"
#include "simulate/field/model/order_field.h"
#include "simulate/noise.h"

namespace grainfield::simulate {

/// What all schemes share: the fields in memory, ψ and D, and how they are saved. A scheme derives
/// from it and implements `step`.
template <class Real>
class FieldEngine : public FieldIntegrator {
 public:
    FieldEngine(const FieldSetup& setup, OrderScheme order_scheme, int threads);

    const FieldSetup& setup() const override { return setup_; }
    void advance(std::int64_t steps) override;
    DensityField density(int replica) const override;
    DensityField order() const override;
    double mean_diffusivity() const override;
    double mass(int replica) const override;
    void save(Checkpoint& checkpoint) const override;
    void restore(const Checkpoint& checkpoint) override;
    std::size_t memory() const override;

 protected:
    using Array = AlignedVector<Real>;

    /// From step_ to step_ + 1 (the base counts).
    virtual void step(Team& team) = 0;

    const Lattice& lattice() const { return setup_.lattice; }
    int row_blocks() const {
        return (lattice().ny + OrderField<Real>::rows_at_once - 1) / OrderField<Real>::rows_at_once;
    }
    /// Whether ψ is to move on before the step that begins now.
    bool order_is_due() const { return setup_.has_order && step_ % setup_.hold == 0; }
    /// ψ to the end of the interval of setup.hold steps that begins now.
    void advance_order(Team& team);
    /// D̄ = (D_n + D_{n+hold})/2 of sixteen rows from `first`, and D_{n+hold} in the place of D_n;
    /// after advance_order.
    void average_diffusivity(int first);
    /// D of the present ψ, everywhere.
    void refresh_diffusivity(Team& team);
    /// D(ψ) of the rows [first, first + 16) of the present modes of ψ, lattice stride.
    void read_diffusivity(int first, Real* out) const;
    /// Noise of unit variance for the density.
    void fill_noise(int replica, std::uint32_t line, std::span<float> out) const;
    /// sqrt(C1 dt / dx^d) / dx: what a unit of noise on a face moves from cell to cell.
    double noise_strength() const;
    DensityField field_of(const Array& array) const;

    FieldSetup setup_;
    int threads_;
    OrderField<Real> order_;
    DiffusivityLaw law_;
    std::vector<NoiseStream> noise_;  // per replica
    std::vector<Array> density_;      // per replica
    Array diffusivity_;               // D of the present ψ
    Array mean_;                      // D̄ of the interval

 private:
    void draw_density(int replica);
    std::vector<double> plain(const Array& array) const;
    void take(const Checkpoint& checkpoint, const std::string& name, Array& array) const;
};

extern template class FieldEngine<float>;
extern template class FieldEngine<double>;

}  // namespace grainfield::simulate
