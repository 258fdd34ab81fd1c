#include "simulate/render/lasting_ids.h"

#include <cmath>

namespace grainfield::simulate {

namespace {

constexpr std::int64_t after_crossing = std::int64_t{1} << 40;  // beyond all grains and copies

}  // namespace

void LastingIds::renumber(Snapshot& truth) {
    for (std::size_t i = 0; i < truth.id.size(); ++i) {
        const Vec2 now = truth.position[i];
        const auto found = last_.try_emplace(truth.id[i], Seen{truth.id[i], now}).first;
        Seen& seen = found->second;
        const Vec2 step = now - seen.position;
        const bool jumped =
            std::abs(step.x) > truth.box.length.x / 2 || std::abs(step.y) > truth.box.length.y / 2;
        if (jumped) seen.id += after_crossing;
        seen.position = now;
        truth.id[i] = seen.id;
    }
}

}  // namespace grainfield::simulate
