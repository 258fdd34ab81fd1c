#pragma once

#include "core/snapshot.h"
#include "core/support/number_archive.h"

namespace grainfield {

/// Saves or restores all columns of a snapshot.
void transfer(NumberArchive& archive, Snapshot& snapshot);

}  // namespace grainfield
