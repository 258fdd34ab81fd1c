#pragma once

#include "core/support/number_archive.h"
#include "tracking/link/linker.h"
#include "tracking/locate.h"

namespace grainfield::tracking {

struct TrackSummary;

/// Save or restore what one frame leaves for the next (Tracker::run, TrackResumption).
void transfer(NumberArchive& archive, Track& track);
void transfer(NumberArchive& archive, LinkSummary& summary);
void transfer(NumberArchive& archive, LinkState& state);
void transfer(NumberArchive& archive, Located& found);
void transfer(NumberArchive& archive, TrackSummary& summary);

}  // namespace grainfield::tracking
