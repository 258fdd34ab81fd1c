#pragma once

#include <vector>

#include "analysis/structure_factor.h"
#include "core/density_field.h"
#include "core/progress.h"
#include "core/results.h"

namespace grainfield::analysis {

/// Measures all fields of a source (FieldStatistics), one after the other. Throws Interrupted,
/// InputError.
std::vector<ObservableResult> analyze_fields(FieldSource& source,
                                             const StructureFactorOptions& options,
                                             Progress& progress);

}  // namespace grainfield::analysis
