#include "simulate/render/lasting_ids.h"

#include <cmath>

namespace grainfield::simulate {

void LastingIds::renumber(Snapshot& truth) {
    for (std::size_t i = 0; i < truth.id.size(); ++i) {
        const Vec2 now = truth.position[i];
        const auto [found, is_new] = last_.try_emplace(truth.id[i], Seen{next_, now});
        Seen& seen = found->second;
        const Vec2 step = now - seen.position;
        const bool jumped =
            std::abs(step.x) > truth.box.length.x / 2 || std::abs(step.y) > truth.box.length.y / 2;
        if (is_new || jumped) seen.id = next_++;
        seen.position = now;
        truth.id[i] = seen.id;
    }
}

}  // namespace grainfield::simulate
