#include "tests/fuzz/snapshots.h"

#include <algorithm>
#include <cmath>

#include "tests/fuzz/input.h"

namespace grainfield::fuzz {

void read_some(SnapshotSource& snapshots) {
    promise(std::isfinite(snapshots.info().diameter) && snapshots.info().diameter > 0,
            "the diameter is a length");
    const std::int64_t count = std::min<std::int64_t>(snapshots.count(), 8);
    for (std::int64_t i = 0; i < count; ++i) {
        const Snapshot snapshot = snapshots.read(i);
        require_consistent(snapshot);
        require_valid(snapshot.box);
        promise(std::isfinite(snapshot.box.origin.x) && std::isfinite(snapshot.box.origin.y) &&
                    std::isfinite(snapshot.box.height),
                "a box has a place");
        promise(std::isfinite(snapshot.time), "a snapshot has a time");
        promise(std::ranges::all_of(
                    snapshot.position,
                    [](const Vec2& at) { return std::isfinite(at.x) && std::isfinite(at.y); }),
                "positions are finite");
    }
}

}  // namespace grainfield::fuzz
