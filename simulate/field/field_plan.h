#pragma once

#include <cstdint>
#include <vector>

#include "core/run_plan.h"
#include "simulate/field/field_options.h"
#include "simulate/field/integrators/adjoint.h"
#include "simulate/field/integrators/field_integrator.h"

namespace grainfield::simulate {

/// When a run looks at its fields, in steps from the start.
struct FieldSchedule {
    std::int64_t relax = 0;
    std::int64_t samples = 0;  ///< how many
    std::int64_t between_samples = 1;
    std::int64_t between_stores = 0;  ///< 0: only the last field is stored

    std::int64_t total() const { return relax + samples * between_samples; }
};

/// What will be done: options with everything left open decided.
struct FieldPlan {
    FieldSetup setup;
    FieldSchedule schedule;
    std::vector<LatticeWave> waves;  ///< not empty: the adjoint estimator instead of a density
    const char* scheme = "lod";      ///< for people and the record
    int threads = 1;                 ///< as many as pay: 16384 cells each, one on a line
};

/// Decides scheme, precision, noise, k_cut and hold, and says in `plan` what is skipped and why:
///
/// - explicit below dx²/(2 d D0), else lod (a given explicit scheme above the bound is refused);
/// - k_cut: modes of ψ above change S by 5 (2λv)², v their variance (measured,
/// docs/field/schemes.md); the
///   cut leaves them a quarter of the tolerance;
/// - hold: ψ held for m steps biases S by about 1 % a unit of m dt (explicit scheme only);
/// - λ = 0: no ψ at all; uniform noise unless fields are stored; single precision unless the
///   tolerance is below 1e-4.
///
/// Throws OptionError for odd b, lattices without rows, waves that are none.
FieldPlan plan_field(const FieldOptions& options, RunPlan& plan);

}  // namespace grainfield::simulate
