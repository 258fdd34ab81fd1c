#pragma once

#include "core/support/number_archive.h"
#include "core/snapshot.h"

namespace grainfield {

/// Saves or restores all columns of a snapshot.
void transfer(NumberArchive& archive, Snapshot& snapshot);

}  // namespace grainfield
