#pragma once

#include "core/job_size.h"
#include "simulate/field/field_options.h"

namespace grainfield::simulate {

/// What a run of the field model needs. Bytes a cell are those of the largest resident set
/// (measured): 36, 29 for each density, 21 for ψ, 16 for double precision, 32 for
/// the adjoint. Some 7 ns a cell, step and density, twice that in double.
JobSize size_of(const FieldOptions& options);

}  // namespace grainfield::simulate
