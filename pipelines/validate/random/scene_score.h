#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/frame.h"
#include "core/snapshot.h"
#include "pipelines/validate/random/drawn_scene.h"
#include "tracking/model/disc_profile.h"
#include "tracking/tracker.h"

namespace grainfield::pipelines {

/// How well one drawn scene was tracked. Numbers are over the spheres whose true centre is at least
/// D inside the frame, D = 0.88 a: the apparent diameter of steel over a panel, so that scores do
/// not depend on what a tracker calibrates. Pairs are within D/4 (docs/validation.md).
struct SceneScore {
    std::int64_t index = 0;
    DrawnScene drawn;
    bool is_calibrated = false;  ///< else all spheres are missed
    std::int64_t spheres = 0;    ///< true ones
    std::int64_t missed = 0;
    std::int64_t spurious = 0;   ///< false ones
    double rmse = 0;             ///< per axis [a]; NaN: nothing was found
    double pull_rms = 0;         ///< of error over reported standard error; NaN as above
    double within = 0;           ///< share of errors within twice the reported one
    double residual = 0;         ///< RMS of image − model [contrast]
    double us_per_sphere = 0;    ///< processor time of a cold frame after calibration [µs]
    tracking::DiscProfile disc;  ///< as calibrated

    double recall() const;
    double false_share() const;  ///< false spheres / true ones
};

/// A scene with what was found in it.
struct SeenScene {
    SceneScore score;
    Frame frame;
    Snapshot truth;  ///< [px], z and layers; all whose centre is in the frame
    Snapshot found;
    std::vector<Vec2> missed;    ///< [px], of those that count
    std::vector<Vec2> spurious;  ///< [px]
};

/// Simulates, renders and tracks scene `index`, on one thread. Same bits wherever and whenever.
/// Throws PhysicsError if the layer collapses, Interrupted.
SeenScene see_scene(const DrawnScene& drawn, std::int64_t index,
                    const tracking::TrackOptions& tracking);

/// Scores and marks what was found in `scene.found` against `scene.truth`; sets those fields of its
/// score that are counts or errors.
void score_scene(SeenScene& scene);

/// The camera and the layer as TOML, one line a number: "panel-distance = 9.1  # [a]".
std::string toml_of(const DrawnScene& drawn);

}  // namespace grainfield::pipelines
