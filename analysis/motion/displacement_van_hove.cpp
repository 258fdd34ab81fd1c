#include <cmath>
#include <vector>

#include "analysis/motion/displacement.h"
#include "analysis/motion/van_hove.h"

namespace grainfield::analysis {

void Displacement::add_van_hove(const Clock& clock, ObservableResult& result) const {
    for (const std::int64_t frames : options_.van_hove) {
        // Between two slots there is no pair, nor beyond the last.
        const double wanted_lag = static_cast<double>(frames) * clock.per_frame;
        const double nearest = std::round(wanted_lag);
        const double missed = std::abs(wanted_lag - nearest) / clock.per_frame;  // frames
        const bool is_there =
            missed < 0.1 && nearest >= 1 && nearest < static_cast<double>(clock.slots);
        const std::size_t lag = is_there ? static_cast<std::size_t>(nearest) : clock.slots;
        // First the root mean square, which sets the bins.
        double width = 0;
        std::vector<VanHoveGroup> sums;
        for (const bool counts : {false, true}) {
            sums.assign(groups, VanHoveGroup{std::vector<double>(van_hove_bins, 0.0)});
            for (const Track& track : tracks_) {
                const std::size_t group = (identity_hash(track.id) >> 56) % groups;
                std::size_t later = 0;
                for (std::size_t i = 0; i < track.step.size(); ++i) {
                    const std::size_t wanted = clock.slot[track.first + i] + lag;
                    while (later < track.step.size() && clock.slot[track.first + later] < wanted) {
                        ++later;
                    }
                    if (later == track.step.size()) break;
                    if (clock.slot[track.first + later] != wanted) continue;
                    const Vec2 d = track.step[later] - track.step[i];
                    if (is_finite(d)) sums[group].add(d, counts ? width : 1);
                }
            }
            const VanHoveGroup all = pooled(sums, groups);
            if (!counts && all.number > 0) width = 0.2 * std::sqrt(all.squares / all.number);
            if (!(width > 0)) break;
        }
        add_van_hove_lag(sums, width > 0 ? width : 1, frames, lag_times(clock, {lag}).front(),
                         result);
    }
}

}  // namespace grainfield::analysis
