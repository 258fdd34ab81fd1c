#include "tracking/refine/drawing_order.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"
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
            anchors.push_back(Anchor::of(
                {random.uniform(-0.5, width - 0.5), random.uniform(-0.5, height - 0.5)}));
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

// Strips are drawn side by side, then seams: threads must not meet.
TEST(DrawingOrder, StripsShareNoPixelWithOneAnotherNorSeams) {
    const Frame frame(900, 200, {14, 1.2});
    const DrawingOrder order(frame.image, frame.stencil, frame.anchors);
    // Before anybody is visited: which disc was drawn, by part; with one thread strips follow one
    // another, and a new one begins at the top.
    std::vector<std::vector<std::uint32_t>> groups(1);
    int highest = -1;
    order.draw_and_visit(
        1, frame.image, frame.image,
        [&](std::uint32_t j) {
            const int height = static_cast<int>(frame.stencil.rows().size());
            const int row = std::min(frame.anchors[j].y / height, (200 - 1) / height);
            if (row < highest) groups.emplace_back();
            highest = row;
            groups.back().push_back(j);
        },
        [](int, const std::vector<std::uint32_t>&) {});
    ASSERT_EQ(groups.size(), 7U) << "four strips and three seams";
    const auto are_apart = [&](std::size_t a, std::size_t b) {
        for (const std::uint32_t i : groups[a]) {
            for (const std::uint32_t j : groups[b]) {
                if (frame.share(i, j)) return false;
            }
        }
        return true;
    };
    for (std::size_t a = 0; a < 7; ++a) {
        const std::size_t end = a < 4 ? 4 : 7;
        for (std::size_t b = a + 1; b < end; ++b) EXPECT_TRUE(are_apart(a, b)) << a << " " << b;
    }
    EXPECT_FALSE(are_apart(0, 4)) << "a seam lies beside its strip";
}

}  // namespace
}  // namespace grainfield::tracking
