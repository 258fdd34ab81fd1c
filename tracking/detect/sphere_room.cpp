#include "tracking/detect/sphere_room.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "core/support/parallel.h"

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

void SphereRoom::correct_all(int threads) {
    if (!corrector_) return;
    std::vector<Vec2> places(fit_.positions().size());
    parallel_for(static_cast<std::int64_t>(places.size()), threads, [&](std::int64_t j) {
        places[static_cast<std::size_t>(j)] = corrected(static_cast<std::uint32_t>(j));
    });
    corrected_ = std::move(places);
}

Vec2 SphereRoom::corrected(std::uint32_t j) const {
    if (!corrected_.empty()) return corrected_[j];
    const Vec2 p = fit_.positions()[j];
    const Vec2 way = corrector_->corrected(p) - p;
    const double most = kMostCorrected * cell_.diameter;
    return norm(way) > most ? p + (most / norm(way)) * way : p + way;
}

std::vector<std::uint32_t> SphereRoom::neighbours(std::size_t j,
                                                  const std::vector<char>& present) const {
    std::vector<std::uint32_t> found;
    discs_.near(fit_.positions()[j], reach_, [&](std::uint32_t other, Vec2) {
        if (other != j && (present.empty() || present[other] != 0)) found.push_back(other);
    });
    return found;
}

bool SphereRoom::is_corrected(std::size_t j, const std::vector<std::uint32_t>& neighbours) const {
    const auto reaches = [&](std::size_t disc) {
        return corrector_->reaches(fit_.positions()[disc]);
    };
    return corrector_ && reaches(j) && std::ranges::all_of(neighbours, reaches);
}

bool SphereRoom::is_corrected(std::size_t j) const {
    return is_corrected(j, neighbours(j, {}));
}

bool SphereRoom::has(std::size_t j, GrantedRoom granted, const std::vector<char>& present) const {
    const std::vector<std::uint32_t> near = neighbours(j, present);
    const bool at_corrected = is_corrected(j, near);
    const auto place = [&](std::size_t disc) {
        return at_corrected ? corrected(static_cast<std::uint32_t>(disc)) : fit_.positions()[disc];
    };
    std::vector<Vec2> others;
    others.reserve(near.size());
    for (const std::uint32_t other : near) others.push_back(place(other));
    return has_room(cell_, place(j), others, at_corrected ? granted.corrected : granted.fitted);
}

}  // namespace grainfield::tracking
