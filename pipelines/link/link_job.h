#pragma once

#include <cstdint>
#include <filesystem>

#include "core/option_table.h"
#include "pipelines/job.h"
#include "tracking/layers/bilayer.h"
#include "tracking/link/linker.h"

namespace grainfield::pipelines {

/// What linking is asked for; the parts are the inputs of the job, in any order.
struct LinkJobOptions {
    std::filesystem::path output;
    tracking::LinkOptions link;
    bool allow_gaps = false;      ///< frames that no part has count as missing
    bool allow_overlaps = false;  ///< frames that two parts have are taken from the earlier part
};

/// What linking did.
struct LinkJobResult {
    std::int64_t parts = 0;
    std::int64_t frames = 0;
    double particles_mean = 0;
    tracking::LinkSummary links;
    double step_rms = 0;                ///< between consecutive frames [px]
    tracking::Bilayer::Summary layers;  ///< zeros where layers do not follow from overlaps
};

/// Checks the parts and says in the plan what link_parts would do. Throws as that does.
void plan_linking(const LinkJobOptions& options, Job& job);

/// Gives the spheres of all parts of a film (FilmOptions::is_part) their identities, and layers
/// where they follow from overlaps, and writes one trajectory.
///
/// The numbers are those of the film tracked in one piece with the same options of linking: the
/// same positions and identities, bit by bit. Frames are read one at a time, so memory does not
/// grow with the film. Throws InputError, naming the part and its frames, if a file is no part, if
/// parts differ in film, options or calibration, and for gaps and overlaps that are not allowed;
/// OutputError; Interrupted, and no output, after a signal.
LinkJobResult link_parts(const LinkJobOptions& options, Job& job);

}  // namespace grainfield::pipelines
