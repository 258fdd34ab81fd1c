#include "pipelines/render/snapshot_window.h"

namespace grainfield::pipelines {

// Grows what is kept by one snapshot, at either end; anything else begins anew.
const Snapshot& SnapshotWindow::at(std::int64_t index) {
    const auto count = static_cast<std::int64_t>(kept_.size());
    if (count == 0 || index < first_ - 1 || index > first_ + count) {
        kept_.clear();
        first_ = index;
        kept_.push_back(source_.read(index));
    } else if (index == first_ - 1) {
        kept_.insert(kept_.begin(), source_.read(index));
        first_ = index;
    } else if (index == first_ + count) {
        kept_.push_back(source_.read(index));
    }
    return kept_[static_cast<std::size_t>(index - first_)];
}

simulate::SnapshotSeries SnapshotWindow::around(std::int64_t index, double reach) {
    const double now = at(index).time;
    std::int64_t low = index;
    std::int64_t high = index;
    if (reach > 0) {
        while (low > 0 && now - at(low).time < reach) --low;
        while (high + 1 < source_.count() && at(high).time - now < reach) ++high;
        at(low);
        at(high);
    }
    kept_.erase(kept_.begin(), kept_.begin() + (low - first_));
    kept_.resize(static_cast<std::size_t>(high - low + 1));
    first_ = low;
    return {kept_, static_cast<std::size_t>(index - low)};
}

}  // namespace grainfield::pipelines
