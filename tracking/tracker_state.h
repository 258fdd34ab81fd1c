#pragma once

#include "core/support/number_archive.h"
#include "tracking/tracker.h"

namespace grainfield::tracking {

/// Save or restore what one frame leaves for the next (Tracker::run, TrackResumption). A member
/// that is added to one of these structs does not compile until it stands here (NumberArchive).
void transfer(NumberArchive& archive, Track& track);
void transfer(NumberArchive& archive, SubnetCounts& counts);
void transfer(NumberArchive& archive, LinkSummary& summary);
void transfer(NumberArchive& archive, LinkState& state);
void transfer(NumberArchive& archive, Located& found);
void transfer(NumberArchive& archive, FrameTimes& times);
void transfer(NumberArchive& archive, TrackSummary& summary);

}  // namespace grainfield::tracking
