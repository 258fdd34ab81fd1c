#pragma once

#include <cstdint>
#include <vector>

#include "core/vec2.h"

namespace grainfield::tracking {

/// Identified positions of one frame; position[i] belongs to track id[i].
struct IdentifiedFrame {
    std::vector<std::int64_t> id;
    std::vector<Vec2> position;
};

/// How well tracks meet the true ones: measures of the ISBI challenge (`chenouard2014`), identity
/// switches and fragmentations (`bernardin2008`).
///
/// The distance of a true track X and a found one Y is the sum over frames of min(|x − y|, ε), ε
/// where only one of them exists. Tracks are paired one-to-one so that the sum of distances is
/// least; a true track may stay alone at the cost of ε a frame. Shares of nothing have no value
/// (NaN): α and β without true tracks, the Jaccard indices without any.
struct TrackScores {
    double alpha = 0;  ///< 1 − d(X, Y)/d(X, ∅): 1 perfect, 0 nothing found
    double beta = 0;   ///< α less what spurious tracks cost: (d₀ − d)/(d₀ + d(Ȳ, ∅))
    double jaccard_points = 0;   ///< TP/(TP + FN + FP) of positions nearer than ε in paired tracks
    double jaccard_tracks = 0;   ///< same of tracks (JSCθ)
    std::int64_t links = 0;      ///< times a true particle was found again
    std::int64_t switches = 0;   ///< of those, under another identity than last time
    std::int64_t fragments = 0;  ///< of those, after frames in which it existed and was not found
    std::int64_t wrong_links = 0;  ///< steps of a found track from one true particle to another

    /// The share of links under the identity of last time; NaN where there was nothing to link.
    double correct_link_fraction() const;
};

/// Frames are counted by index in both lists; a frame that was not tracked is an empty one.
/// `epsilon` [px]; 0.25 D for grains. Switches, fragments and wrong links use match_positions in
/// each frame. Memory: 100 B for each pair of tracks that ever come nearer than ε.
TrackScores score_tracks(const std::vector<IdentifiedFrame>& found,
                         const std::vector<IdentifiedFrame>& truth, double epsilon);

}  // namespace grainfield::tracking
