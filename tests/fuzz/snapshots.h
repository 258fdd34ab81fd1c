#pragma once

#include "core/trajectory.h"

namespace grainfield::fuzz {

/// Reads the first snapshots and checks that what was taken is sound (see `promise`).
void read_some(SnapshotSource& snapshots);

}  // namespace grainfield::fuzz
