#pragma once

#include <cstdint>

#include "core/density_field.h"
#include "core/support/checkpoint.h"
#include "simulate/field/field_options.h"
#include "simulate/field/model/lattice.h"

namespace grainfield::simulate {

enum class FieldScheme { lod, explicit_lm, paper };

/// What the plan has made of the options: nothing is left open.
struct FieldSetup {
    Lattice lattice;
    ModelOptions model;
    FieldScheme scheme = FieldScheme::lod;
    double dt = 0.5;
    bool twofold = false;  ///< double precision
    NoiseShape noise = NoiseShape::uniform;
    double k_cut = 0;  ///< ψ has no modes above
    int hold = 1;      ///< steps for which one ψ serves
    int substeps = 1;  ///< in which ψ crosses them (same law): to compare steps on one path of ψ
    int replicas = 1;
    std::uint64_t seed = 1;
    bool has_order = true;  ///< false: λ = 0, D = D0, no ψ at all
};

/// The coupled fields of one realisation (`castillo2019`, docs/field.md):
///
///   ∂tψ = −(ν + μ(−∇²)^{b/2})ψ + ξ,   ∂tρ = ∇·(D(ψ)∇ρ + η),
///
/// ρ at cell centres with D on a face the mean of its two cells; ψ by its Fourier modes. Starts in
/// the stationary state of ψ, with ρ white of variance C1/(2 D0 dx^d) and mean 0.
///
/// Same setup and seed give the same bits for any number of threads and after any number of
/// save/restore (on one kind of machine: vector width and FFTW's choice of code differ between
/// kinds). Cost O(cells log cells) a step.
class FieldIntegrator {
 public:
    virtual ~FieldIntegrator() = default;
    virtual const FieldSetup& setup() const = 0;
    virtual void advance(std::int64_t steps) = 0;

    std::int64_t step() const { return step_; }
    double time() const { return static_cast<double>(step_) * setup().dt; }

    /// ρ of a replica. Leimkuhler–Matthews: z = ρ + w/2, whose statistics are those of the model.
    virtual DensityField density(int replica) const = 0;
    /// ψ; all 0 without it.
    virtual DensityField order() const = 0;
    /// ⟨D⟩ over the cells.
    virtual double mean_diffusivity() const = 0;
    /// ∫ρ, which every scheme conserves up to rounding.
    virtual double mass(int replica) const = 0;

    /// Everything but the options: modes of ψ, D, ρ (not sampled), step.
    virtual void save(Checkpoint& checkpoint) const = 0;
    /// Throws InputError if an array is missing, of another length, or holds what is not finite.
    virtual void restore(const Checkpoint& checkpoint) = 0;

    /// Bytes of the fields, tables and buffers.
    virtual std::size_t memory() const = 0;

 protected:
    std::int64_t step_ = 0;
};

}  // namespace grainfield::simulate
