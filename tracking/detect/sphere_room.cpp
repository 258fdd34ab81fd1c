#include "tracking/detect/sphere_room.h"

#include <algorithm>
#include <cstdint>

namespace grainfield::tracking {

SphereRoom::SphereRoom(const JointFit& fit, const SphereCell& cell,
                       const BiasCorrection* correction)
    : fit_(fit),
      cell_(cell),
      reach_(cell.diameter * (correction != nullptr ? 1 + 2 * kMostCorrected : 1)),
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

std::vector<Vec2> SphereRoom::neighbours(std::size_t j, const std::vector<char>& present) const {
    std::vector<Vec2> found;
    discs_.near(fit_.positions()[j], reach_, [&](std::uint32_t other, Vec2 p) {
        if (other != j && (present.empty() || present[other] != 0)) found.push_back(p);
    });
    return found;
}

bool SphereRoom::is_corrected(Vec2 place, const std::vector<Vec2>& neighbours) const {
    const auto reaches = [&](Vec2 p) { return corrector_->reaches(p); };
    return corrector_ && reaches(place) && std::ranges::all_of(neighbours, reaches);
}

bool SphereRoom::is_corrected(std::size_t j) const {
    return is_corrected(fit_.positions()[j], neighbours(j, {}));
}

bool SphereRoom::has(std::size_t j, GrantedRoom granted, const std::vector<char>& present) const {
    const Vec2 place = fit_.positions()[j];
    std::vector<Vec2> others = neighbours(j, present);
    if (!is_corrected(place, others)) return has_room(cell_, place, others, granted.fitted);
    for (Vec2& p : others) p = corrected(p);
    return has_room(cell_, corrected(place), others, granted.corrected);
}

}  // namespace grainfield::tracking
