#pragma once

#include <cstddef>

#include "simulate/field/field_options.h"

namespace grainfield::simulate {

/// D as a function of ψ where the modes of ψ above k_cut were left out and replaced by their
/// average, ψ = ψ_kept + χ, ⟨χ²⟩ = v:
///   exponential: ⟨D⟩_χ = D0 (1 + 2λv)^{-1/2} exp(−λψ²/(1 + 2λv)), exact for Gaussian χ;
///   other forms: v must be 0.
struct DiffusivityLaw {
    DiffusivityForm form = DiffusivityForm::exponential;
    double d0 = 1;
    double lambda = 1;

    static DiffusivityLaw of(const ModelOptions& model, double missing_variance);
    double operator()(double psi) const;
};

/// D of `count` numbers (exponential form: error 1–2 units in the last place; λψ² beyond the range
/// of exp gives 0). In and out may be the same array.
template <class Real>
void diffusivities(const DiffusivityLaw& law, const Real* psi, Real* out, std::size_t count);

}  // namespace grainfield::simulate
