#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "core/vec2.h"
#include "tracking/refine/disc_scene.h"

namespace grainfield::tracking {

/// What is known of the motion of a disc. A new disc has moved by kFresh.
struct DiscMotion {
    static constexpr float kFresh = std::numeric_limits<float>::max();

    float last_step = kFresh;   ///< [px]
    float left = kFresh;        ///< [px] expected of the next step
    float drift = kFresh;       ///< [px] path since `explained`
    bool is_disturbed = false;  ///< moved in another way than by a joint step
    double explained = 0;       ///< as of the last call of JointFit::explained()

    /// In the precision of `left`: a disc that is said to be a tolerance away rests.
    bool is_restless(double tolerance) const { return left > static_cast<float>(tolerance); }
};

/// What sweeps and joint steps work on: discs as drawn, positions, and what is known of each.
struct FittedDiscs {
    DiscScene scene;
    int threads;
    std::vector<Vec2> position;      ///< [px]
    std::vector<DiscMotion> motion;  ///< of each disc
    bool some_pending = false;       ///< by more than the lag of exact sweeps, perhaps
    std::uint64_t revision = 0;      ///< goes up with everything that is drawn

    static constexpr double kLongestStep = 0.25;  ///< [px] of a joint step
    static constexpr int kInnerSweeps = 2;        ///< more visits to a tile in one sweep

    std::size_t size() const { return position.size(); }
    void append(Vec2 p, std::optional<double> explained, std::optional<double> left);

    /// Calls body(discs of a tile) for tiles of the image, in parallel where they are far enough
    /// from each other: discs of two such tiles never write the same pixel, though each may take
    /// 1 + kInnerSweeps steps.
    void in_tiles(const std::vector<std::uint32_t>& discs,
                  const std::function<void(const std::vector<std::uint32_t>&)>& body) const;

    /// From where a disc is drawn to where it is [px].
    Vec2 pending_step(std::size_t j) const { return position[j] - scene[j].centre; }
    void draw_pending();
    void draw_pending_near(const std::vector<Vec2>& places, double range, Drawing drawing);
    /// Draws these discs where they are.
    void redraw(const std::vector<std::uint32_t>& discs, Drawing drawing);
};

}  // namespace grainfield::tracking
