#include "tracking/link/linker.h"

#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "core/random.h"
#include "tests/support/layer_frames.h"

namespace grainfield::tracking {
namespace {

TEST(Linker, KeepsIdentitiesWhateverTheOrderOfTheParticles) {
    Linker linker({.search_range = 3, .memory = 0});
    const auto first = linker.link(0, {{10, 10}, {20, 20}, {30, 30}});
    const auto second = linker.link(1, {{30.5, 30}, {10, 11}, {20, 19.2}});
    EXPECT_EQ(second, (std::vector<std::int64_t>{first[2], first[0], first[1]}));
}

TEST(Linker, StartsNewTracksBeyondTheSearchRange) {
    Linker linker({.search_range = 3, .memory = 0});
    linker.link(0, {{10, 10}});
    EXPECT_EQ(linker.link(1, {{13.01, 10}}), std::vector<std::int64_t>{1});
    EXPECT_EQ(linker.summary().started, 2);
    linker.link(2, {});
    EXPECT_EQ(linker.summary().ended, 1);
}

TEST(Linker, MemoryBridgesAMissingDetectionAndNoMore) {
    Linker linker({.search_range = 3, .memory = 2});
    linker.link(0, {{10, 10}, {50, 50}});
    linker.link(1, {{50, 50}});
    linker.link(2, {{50, 50}});
    EXPECT_EQ(linker.link(3, {{10.5, 10}, {50, 50}})[0], 0);
    EXPECT_EQ(linker.summary().bridged, 1);

    Linker forgetful({.search_range = 3, .memory = 1});
    forgetful.link(0, {{10, 10}});
    forgetful.link(1, {});
    forgetful.link(2, {});
    EXPECT_EQ(forgetful.link(3, {{10, 10}})[0], 1);
}

TEST(Linker, AFrameThatIsLeftOutCountsAsMissing) {
    Linker linker({.search_range = 3, .memory = 0});
    linker.link(0, {{10, 10}});
    EXPECT_EQ(linker.link(2, {{10, 10}})[0], 1);
}

TEST(Linker, NearestPairsAreTakenFirst) {
    Linker linker({.search_range = 5, .memory = 0});
    linker.link(0, {{10, 10}, {14, 10}});
    // The second track is nearer to the only particle.
    EXPECT_EQ(linker.link(1, {{13, 10}})[0], 1);
}

TEST(Linker, MakesNoWrongLinkInADenseLayerAtATenthOfTheSpacing) {
    auto scene = testing::hard_disc_liquid(400, 400, 10, 0.7, 8);
    std::vector<Vec2> positions = scene.position;
    Linker linker({.search_range = 5, .memory = 0});
    const auto ids = linker.link(0, positions);
    RandomStream random(4, "steps");
    for (int frame = 1; frame < 20; ++frame) {
        for (Vec2& p : positions) p += Vec2{0.5 * random.normal(), 0.5 * random.normal()};
        // Steps are RMS 0.7 px; half the smallest spacing is 5 px, a wrong link needs 7 σ.
        const auto now = linker.link(frame, positions);
        ASSERT_EQ(now, ids) << frame;
        positions = scene.position;
    }
}

TEST(Linker, ManyParticlesAtOnePointAndNoneAtAllAreHarmless) {
    Linker linker({.search_range = 1, .memory = 1});
    linker.link(0, std::vector<Vec2>(300, Vec2{5, 5}));
    auto ids = linker.link(1, std::vector<Vec2>(300, Vec2{5, 5}));
    std::sort(ids.begin(), ids.end());
    EXPECT_EQ(std::unique(ids.begin(), ids.end()), ids.end());
    EXPECT_TRUE(linker.link(2, {}).empty());
}

}  // namespace
}  // namespace grainfield::tracking
