#pragma once

#include <cstdint>
#include <vector>

#include "core/snapshot.h"
#include "core/vec2.h"

namespace grainfield::tracking {

/// How many layer labels are right. A silhouette tells which spheres of a cluster lie in the same
/// layer, not which layer is on top. So labels are also counted up to one exchange of the layers in
/// each cluster of labelled spheres that overlap. One label of every cluster then only names its
/// sides and proves nothing: of n labels, r right ones in the better of both namings, max(r, n − r)
/// − 1 of n − 1 are counted as right. Labels drawn by lot so score 1/2 in pairs, 5/8 in clusters of
/// three and less than that, towards 1/2, in larger ones.
struct LayerScore {
    std::int64_t matched = 0;           ///< particles found whose true layer is known
    std::int64_t labelled = 0;          ///< of those, with a label
    std::int64_t right = 0;             ///< of those, with the true one
    std::int64_t tested = 0;            ///< labelled, but for one of each cluster: Σ (n − 1)
    std::int64_t right_up_to_flip = 0;  ///< of those, in the better naming of each cluster

    double named() const;                ///< labelled/matched; NaN without matches
    double accuracy() const;             ///< right/labelled; NaN without labels
    double accuracy_up_to_flip() const;  ///< right_up_to_flip/tested; NaN if no two labels overlap

    /// Adds one frame. `partner`: of each true particle the index found (match_positions). Clusters
    /// are those of the particles with a label that are nearer to each other than `contact` [px].
    void add(const std::vector<Vec2>& truth, const std::vector<Layer>& true_layer,
             const std::vector<Layer>& found_layer, const std::vector<int>& partner,
             double contact);
};

}  // namespace grainfield::tracking
