#include "tracking/refine/drawing_order.h"

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <vector>

#include <gtest/gtest.h>

#include "core/random.h"
#include "tracking/refine/disc_kernel.h"

namespace grainfield::tracking {
namespace {

struct Frame {
    PaddedImage image;
    DiscStencil stencil;
    std::vector<Anchor> anchors;

    Frame(int width, int height, const DiscProfile& disc)
        : image(clear_transmission(width, height, disc)), stencil(disc, image.pitch()) {
        RandomStream random(7, "anchors");
        for (int i = 0; i < width * height / 150; ++i) {
            anchors.push_back(
                Anchor::of({random.uniform(-0.5, width - 0.5), random.uniform(-0.5, height - 0.5)}));
        }
    }

    /// The windows of two discs share pixels: rows begin where the anchor's first one does.
    bool share(std::size_t a, std::size_t b) const {
        return std::abs(anchors[a].x - anchors[b].x) < stencil.width() &&
               std::abs(anchors[a].y - anchors[b].y) < static_cast<int>(stencil.rows().size());
    }
};

TEST(DrawingOrder, WhoIsVisitedSeesAllDiscsThatShareItsPixels) {
    for (const auto& [width, height] : {std::pair{900, 200}, {220, 500}, {30, 40}}) {
        const Frame frame(width, height, {14, 1.2});
        const DrawingOrder order(frame.image, frame.stencil, frame.anchors);
        std::vector<int> drawn(frame.anchors.size());
        std::vector<int> visited(frame.anchors.size());
        order.draw_and_visit(
            1, frame.image, frame.image, [&](std::uint32_t j) { ++drawn[j]; },
            [&](int, const std::vector<std::uint32_t>& discs) {
                for (const std::uint32_t j : discs) {
                    ++visited[j];
                    for (std::size_t k = 0; k < drawn.size(); ++k) {
                        if (!frame.share(j, k)) continue;
                        EXPECT_EQ(drawn[k], 1) << j << " sees " << k;
                    }
                }
            });
        EXPECT_EQ(drawn, std::vector<int>(drawn.size(), 1));
        EXPECT_EQ(visited, std::vector<int>(visited.size(), 1));
    }
}

TEST(DrawingOrder, PartsAreTheSameForAnyNumberOfThreads) {
    const Frame frame(700, 300, {14, 1.2});
    const DrawingOrder order(frame.image, frame.stencil, frame.anchors);
    const int parts = DrawingOrder::parts(frame.image, frame.stencil);
    const auto discs_of_parts = [&](int threads) {
        std::vector<std::vector<std::uint32_t>> discs(static_cast<std::size_t>(parts));
        std::mutex mutex;
        order.visit(threads, [&](int part, const std::vector<std::uint32_t>& of_part) {
            const std::lock_guard lock(mutex);
            discs[static_cast<std::size_t>(part)] = of_part;
        });
        return discs;
    };
    const auto one = discs_of_parts(1);
    EXPECT_GT(std::ranges::count_if(one, [](const auto& discs) { return !discs.empty(); }), 20);
    EXPECT_EQ(discs_of_parts(5), one);
}

}  // namespace
}  // namespace grainfield::tracking
