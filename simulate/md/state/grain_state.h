#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/vec3.h"

namespace grainfield::simulate {

/// Of a grain that has not collided (last_contact).
constexpr double no_contact_yet = -1e300;

/// All grains at one instant, in the order of the engine's memory.
///
/// This is what a run must keep to go on bit-identically: predictions follow from it.
struct GrainState {
    std::vector<Vec3> position;        ///< of the centre; z above the resting low plate [a]
    std::vector<Vec3> velocity;        ///< [sqrt(g a)]
    std::vector<Vec3> spin;            ///< angular velocity [sqrt(g/a)]
    std::vector<std::int32_t> id;      ///< identity, 0 … N − 1
    std::vector<double> last_contact;  ///< time of the last collision relative to this instant,
                                       ///< ≤ 0 [sqrt(a/g)]; empty without TC model

    std::size_t size() const { return position.size(); }
    void resize(std::size_t count);
};

}  // namespace grainfield::simulate
