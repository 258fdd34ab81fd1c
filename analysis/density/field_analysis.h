#pragma once

#include <string>
#include <vector>

#include "analysis/density/synthetic_result.h"
#include "analysis/spectra/fit_result.h"
#include "analysis/spectra/structure_factor.h"
#include "core/density_field.h"
#include "core/results.h"
#include "core/support/progress.h"

namespace grainfield::analysis {

/// What is measured on fields, and what is made of their S(k).
struct FieldAnalysisOptions {
    StructureFactorOptions sk;
    FitOptions fit;
    SyntheticOptions synthetic;
};

/// Measures all fields of a source (FieldStatistics), one after the other, and adds "fit" and
/// "synthetic" by the estimators of particles. Throws Interrupted, InputError.
std::vector<ObservableResult> analyze_fields(FieldSource& source,
                                             const FieldAnalysisOptions& options,
                                             Progress& progress);

/// Adds "fit" and "synthetic" to what a run accumulated, from the S(k) among its results: errors
/// from the likelihood. `like`: any field of the run, for the lattice; null: not known.
void add_fits(std::vector<ObservableResult>& results, const FieldFrame* like,
              const FieldAnalysisOptions& options);

}  // namespace grainfield::analysis
