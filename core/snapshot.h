#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/box.h"
#include "core/vec2.h"
#include "core/vec3.h"

namespace grainfield {

/// Which layer of the bilayer a particle lies in; a silhouette alone often cannot tell.
enum class Layer : std::int8_t { unknown = -1, bottom = 0, top = 1 };

/// All particles at one instant, column by column.
///
/// `position` has N entries; every other column has N entries or none ("does not apply").
/// Units are those of the TrajectoryInfo that the snapshot belongs to.
struct Snapshot {
    std::int64_t frame = 0;  ///< index in the source, from 0; gaps keep their index
    double time = 0;         ///< [time unit]
    Box box;

    std::vector<Vec2> position;        ///< [length unit]
    std::vector<std::int64_t> id;      ///< identity through time, ≥ 0; empty: not linked
    std::vector<double> z;             ///< of the centre above the resting low plate [length unit]
    std::vector<Vec3> velocity;        ///< [length unit / time unit]
    std::vector<Vec3> spin;            ///< angular velocity [rad / time unit]
    std::vector<Vec2> position_error;  ///< standard error per axis [length unit]
    std::vector<double> z_error;       ///< standard error of z [length unit]
    std::vector<double> quality;       ///< local RMS residual of the image model [contrast]
    std::vector<Layer> layer;

    std::size_t size() const { return position.size(); }
};

/// Throws InputError naming the first column whose length is neither 0 nor N, or the first
/// non-finite position.
void require_consistent(const Snapshot& snapshot);

}  // namespace grainfield
