#pragma once

#include "pipelines/job.h"
#include "pipelines/track/track_values.h"

namespace grainfield::pipelines {

/// Says in the plan what track_film would do; calibrates for it. Throws what track_film throws.
void plan_tracking(const TrackJobOptions& options, Job& job);

/// Tracks the film and writes the trajectory. Of a part (FilmOptions::is_part) the file has no
/// identities, but what link_parts needs (PartRecord). At a signal the frames done so far are a
/// complete output, and a checkpoint beside it is what `resume` goes on from (Resumable, log
/// ".snapshots"): the file in the end is that of a run that was not stopped, byte by byte but for
/// the wall time. With a camera, positions, box and previews are corrected ones, and where its
/// scale is known the diameter of the spheres follows from it, or the spheres' millimetres. A frame
/// that takes longer than a second is given up at a signal. Throws OptionError, InputError,
/// OutputError; InputError too if no frame says what its spheres are, or no frame holds one.
TrackJobResult track_film(const TrackJobOptions& options, Job& job);

}  // namespace grainfield::pipelines
