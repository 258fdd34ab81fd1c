#pragma once

#include "core/job_size.h"
#include "simulate/md/md_options.h"

namespace grainfield::simulate {

/// What a run of molecular dynamics needs: 620 B a grain (measured, largest resident set), 16 B a
/// cell, 32 B a place of the layout, the time series; 10 events a grain and period at a million a
/// second.
JobSize size_of(const MdOptions& options);

}  // namespace grainfield::simulate
