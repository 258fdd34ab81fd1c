#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/vec2.h"
#include "tracking/layers/sphere_cell.h"
#include "tracking/point_grid.h"
#include "tracking/refine/joint_fit.h"
#include "tracking/synthesis/bias_correction.h"

namespace grainfield::tracking {

/// By how much distances may be too short for room between the plates [a].
struct GrantedRoom {
    double corrected;  ///< where the bias of positions is corrected
    double fitted;     ///< where it is not
};

/// Whether the discs of a fit, as it stands, have room between the plates (has_room), each beside
/// all others within a. Distances are those of corrected positions where a correction is known and
/// reaches all of them. The fit outlives it.
class SphereRoom {
 public:
    /// `cell.diameter` > 0. `correction` may be null.
    SphereRoom(const JointFit& fit, const SphereCell& cell, const BiasCorrection* correction);

    /// Corrects all positions at once. Where most discs are asked about it saves what each of them
    /// would cost its neighbours. The fit must not change afterwards.
    void correct_all(int threads);

    /// Whether positions of disc j and of all its neighbours are corrected.
    bool is_corrected(std::size_t j) const;
    /// Of disc j beside those of `present` (all where it is empty).
    bool has(std::size_t j, GrantedRoom granted, const std::vector<char>& present = {}) const;

    /// No correction moves a disc farther: others are not learned from [a].
    static constexpr double kMostCorrected = 0.15;

 private:
    std::vector<std::uint32_t> neighbours(std::size_t j, const std::vector<char>& present) const;
    bool is_corrected(std::size_t j, const std::vector<std::uint32_t>& neighbours) const;
    Vec2 corrected(std::uint32_t j) const;

    const JointFit& fit_;
    SphereCell cell_;
    double reach_;  ///< a neighbour may come nearer by what both are corrected [px]
    PointGrid discs_;
    std::optional<BiasCorrector> corrector_;
    std::vector<Vec2> corrected_ = {};  ///< empty: each is corrected when it is asked for
};

}  // namespace grainfield::tracking
