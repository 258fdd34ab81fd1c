#include "tracking/detect/sphere_room.h"

#include <algorithm>

namespace grainfield::tracking {

SphereRoom::SphereRoom(const JointFit& fit, const SphereCell& cell,
                       const BiasCorrection* correction)
    : fit_(fit),
      cell_(cell),
      reach_(cell.diameter * (correction != nullptr ? 1 + kMostCorrected : 1)),
      discs_(fit.darkness().width(), fit.darkness().height(), reach_) {
    const std::vector<Vec2>& positions = fit.positions();
    for (std::size_t j = 0; j < positions.size(); ++j) {
        discs_.add(positions[j], static_cast<std::uint32_t>(j));
    }
    if (correction != nullptr) {
        corrector_.emplace(*correction, fit.darkness(), fit.transmission(), positions,
                           cell.diameter);
    }
}

Vec2 SphereRoom::corrected(Vec2 p) const {
    const Vec2 way = corrector_->corrected(p) - p;
    const double most = kMostCorrected * cell_.diameter;
    return norm(way) > most ? p + (most / norm(way)) * way : p + way;
}

bool SphereRoom::has(std::size_t j, GrantedRoom granted, const std::vector<char>& present) const {
    const Vec2 place = fit_.positions()[j];
    std::vector<Vec2> neighbours;
    discs_.near(place, reach_, [&](std::uint32_t other, Vec2 p) {
        if (other != j && (present.empty() || present[other] != 0)) neighbours.push_back(p);
    });
    const auto reaches = [&](Vec2 p) { return corrector_->reaches(p); };
    if (!corrector_ || !reaches(place) ||
        !std::all_of(neighbours.begin(), neighbours.end(), reaches)) {
        return has_room(cell_, place, neighbours, granted.fitted);
    }
    for (Vec2& p : neighbours) p = corrected(p);
    return has_room(cell_, corrected(place), neighbours, granted.corrected);
}

}  // namespace grainfield::tracking
