#include "simulate/render/motion/lasting_ids.h"

#include <algorithm>
#include <cmath>

namespace grainfield::simulate {

namespace {

constexpr std::int64_t after_crossing = std::int64_t{1} << 40;  // beyond all grains and copies

}  // namespace

std::vector<Sighting> Continuity::follow(const std::vector<std::int64_t>& id,
                                         const std::vector<Vec2>& position) {
    std::vector<Sighting> sightings;
    sightings.reserve(id.size());
    for (std::size_t i = 0; i < id.size(); ++i) {
        const auto [at, is_new] = last_.try_emplace(id[i], Seen{frame_, position[i]});
        Seen& seen = at->second;
        const Vec2 step = position[i] - seen.position;
        const bool jumped = std::abs(step.x) > span_.x / 2 || std::abs(step.y) > span_.y / 2;
        const bool was_away = absence_ == Absence::ends && seen.frame + 1 < frame_;
        sightings.push_back(is_new               ? Sighting::first
                            : jumped || was_away ? Sighting::another
                                                 : Sighting::same);
        seen = {frame_, position[i]};
    }
    ++frame_;
    return sightings;
}

void LastingIds::follow(const Snapshot& truth) {
    const std::vector<Sighting> sightings = continuity_.follow(truth.id, truth.position);
    for (std::size_t i = 0; i < sightings.size(); ++i) {
        if (sightings[i] == Sighting::another) crossings_[truth.id[i]].push_back(followed_);
    }
    ++followed_;
}

void LastingIds::renumber(Snapshot& truth, std::int64_t frame) const {
    for (std::int64_t& id : truth.id) {
        const auto found = crossings_.find(id);
        if (found == crossings_.end()) continue;
        const auto& frames = found->second;
        id += after_crossing * (std::ranges::upper_bound(frames, frame) - frames.begin());
    }
}

}  // namespace grainfield::simulate
