#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/results.h"
#include "core/trajectory.h"
#include "io/frame_range.h"
#include "io/h5/trajectory_file.h"
#include "tracking/layers/overlap_graph.h"
#include "tracking/tracker.h"

namespace grainfield::pipelines {

/// What the file of a part says besides its snapshots: which frames they are, how they were
/// measured, and what linking needs to know of the film. Two curves of the trajectory file hold it.
struct PartRecord {
    io::FrameSelection film;                ///< frames of the whole film in its source
    FrameSpan span;                         ///< of these the part has measured
    Vec2 origin;                            ///< of the region in the frames of the source [px]
    Vec2 size;                              ///< of the region [px]
    double disc_diameter = 1;               ///< apparent D [px]
    std::optional<double> sphere_diameter;  ///< true a [px]
    std::optional<double> height;           ///< of the cell, where layers follow from overlaps [a]
    double camera_distance = 0;             ///< Z [a]; 0: telecentric
    std::vector<double> calibration;        ///< Tracker::calibration_numbers()

    /// The cell in which layers follow from overlaps, in pixels of the region.
    std::optional<tracking::SphereCell> cell() const;
    /// Position of a frame of the source among those of the film, and back.
    std::int64_t position_of(std::int64_t frame) const { return (frame - film.first) / film.step; }
    std::int64_t frame_at(std::int64_t position) const { return film.first + position * film.step; }
};

/// As the file of a part holds it.
std::vector<Curve> curves_of(const PartRecord& part);

/// Empty if the file is not that of a part. Throws InputError if it is a damaged one.
std::optional<PartRecord> part_record(const io::TrajectoryFile& file,
                                      const std::filesystem::path& path);

/// Whether a curve of a trajectory file is one of curves_of.
bool is_of_part(const Curve& curve);

}  // namespace grainfield::pipelines
