#pragma once

#include "core/quantity_titles.h"
#include "core/results.h"
#include "pipelines/analyze/adjusted_snapshots.h"

namespace grainfield::pipelines {

/// What the tracker found out about the discs, to go with the trajectory: diameter D and edge width
/// w [px], RMS residual of the image model and noise of the camera [contrast].
Curve calibration_curve(double diameter, double edge_width, double residual, double noise);

/// Where the unit of all lengths comes from, as measurements: the particle diameter a with the word
/// "given" or "apparent"; D, w, the residual and the noise where the file holds a calibration, the
/// correction of positions for mirror images [a] where it says what was decided, a in mm where it
/// holds that.
ObservableResult lengths_of(const SnapshotSource& file, const TrajectoryInfo& info,
                            const Adjustment& adjustment);

/// Adds the length of the film and the interval of its frames [time unit], by the time stamps.
void add_times(AdjustedSnapshots& snapshots, ObservableResult& lengths);

/// Of what has no file: a with the word alone.
ObservableResult lengths_of(const TrajectoryInfo& info, const Adjustment& adjustment);

/// What they are called for people.
ObservableTitles lengths_titles();

}  // namespace grainfield::pipelines
