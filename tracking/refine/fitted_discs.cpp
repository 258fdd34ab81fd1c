#include "tracking/refine/fitted_discs.h"

#include <algorithm>

#include "tracking/point_grid.h"
#include "tracking/refine/disc_kernel.h"
#include "tracking/refine/image_cells.h"

namespace grainfield::tracking {
namespace {

// Two images of this size and their surroundings stay in the second-level cache.
constexpr double kTile = 128;  // [px]

}  // namespace

void FittedDiscs::append(Vec2 p, std::optional<double> explained, std::optional<double> left) {
    const Vec2 place = scene.inside(p);
    const float expected = left ? static_cast<float>(*left) : DiscMotion::kFresh;
    position.push_back(place);
    scene.append(place);
    motion.push_back({.last_step = expected,
                      .left = expected,
                      .drift = explained ? 0 : DiscMotion::kFresh,
                      .explained = explained.value_or(0)});
}

void FittedDiscs::in_tiles(
    const std::vector<std::uint32_t>& discs,
    const std::function<void(const std::vector<std::uint32_t>&)>& body) const {
    // A disc writes at most reach and its steps (and the rest of a vector) beyond its tile.
    const double farthest_step = (1 + kInnerSweeps) * longest_step(scene.disc());
    const double furthest = scene.disc().reach() + std::max(1.0, farthest_step) + 1;
    const ImageCells tiles(scene.width(), scene.height(),
                           std::max(kTile, 2 * furthest + PaddedImage::kMostLanes));
    tiles.in_rounds(position, discs, threads, body);
}

void FittedDiscs::draw_pending() {
    std::vector<std::uint32_t> waiting;
    for (std::uint32_t j = 0; j < size(); ++j) {
        if (squared_norm(pending_step(j)) > 0) waiting.push_back(j);
    }
    redraw(waiting, Drawing::exactly);
    some_pending = false;
}

void FittedDiscs::draw_pending_near(const std::vector<Vec2>& places, double range,
                                    Drawing drawing) {
    if (!some_pending) return;
    std::vector<std::uint32_t> waiting;
    for (std::uint32_t j = 0; j < size(); ++j) {
        if (!scene.is_drawn_at(j, position[j], drawing)) waiting.push_back(j);
    }
    if (waiting.empty()) return;
    PointGrid grid(scene.darkness().width(), scene.height(), range);
    for (const Vec2 p : places) grid.add(p, 0);
    std::erase_if(waiting, [&](std::uint32_t j) { return !grid.any(position[j], range); });
    redraw(waiting, drawing);
}

void FittedDiscs::redraw(const std::vector<std::uint32_t>& discs, Drawing drawing) {
    if (discs.empty()) return;
    ++revision;
    in_tiles(discs, [&](const std::vector<std::uint32_t>& tile) {
        for (std::size_t k = 0; k < tile.size(); ++k) {
            if (k + 1 < tile.size()) scene.fetch(tile[k + 1]);
            scene.redraw(tile[k], position[tile[k]], drawing);
        }
    });
}

}  // namespace grainfield::tracking
