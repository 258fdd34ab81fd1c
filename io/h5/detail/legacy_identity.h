#pragma once

#include <string>

#include "core/results.h"

namespace grainfield::io {

/// What files of version 0.1 do not say themselves: it is derived from the names of options, from
/// labels and from the words of warnings as that version recorded them. The one place that does so.

/// Completes the description of a trajectory: Γ = Aω²/g of `simulate md` where gravity is there,
/// and whether the tracker was given the true diameter.
void add_legacy_identity(TrajectoryInfo& info, const RunRecord& record);

/// Dimension, order of the gradient term and ν of `simulate field`.
RunIdentity legacy_field_identity(const RunRecord& field);

/// Of results: from the records of the analysis (`--gamma`) and of the run that it analysed; of
/// `critical`: the series that its label names.
RunIdentity legacy_identity(const Results& results);

WarningCode legacy_warning_code(const std::string& text);

}  // namespace grainfield::io
