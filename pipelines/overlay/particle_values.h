#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "analysis/order/phase.h"
#include "core/trajectory.h"
#include "report/maps/overlay.h"

namespace grainfield::pipelines {

/// What the colours of an overlay tell.
enum class OverlayColour : std::uint8_t {
    order,  ///< |Q4| of the frame
    speed,  ///< from the frame before, or as a simulation says
    layer,
    phase  ///< liquid, solid or between (analysis::PhaseHistory)
};

/// The value of each particle that its colour stands for, frame by frame.
class ParticleValues {
 public:
    /// Looks at some snapshots for the range of speeds, or at all for the phases. The source must
    /// outlive this. Throws InputError if the trajectory does not hold what is to be shown,
    /// Interrupted.
    ParticleValues(OverlayColour colour, SnapshotSource& snapshots);

    const report::ColourKey& key() const { return key_; }
    /// Of snapshots in order of time; NaN: not known.
    std::vector<double> next(const Snapshot& snapshot);

 private:
    std::vector<double> speeds(const Snapshot& snapshot, const Snapshot& other) const;
    std::vector<double> phases(const Snapshot& snapshot) const;
    void find_range();
    void find_phases();

    OverlayColour colour_;
    SnapshotSource& snapshots_;
    double diameter_;
    report::ColourKey key_;
    Snapshot before_;
    std::optional<analysis::PhaseHistory> history_;
};

}  // namespace grainfield::pipelines
