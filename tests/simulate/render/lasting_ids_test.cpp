#include "simulate/render/lasting_ids.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield::simulate {
namespace {

using ::testing::ElementsAre;

constexpr std::int64_t far = std::int64_t{1} << 40;

Snapshot frame_of(std::vector<std::int64_t> id, std::vector<Vec2> position) {
    Snapshot truth;
    truth.box = {{-0.5, -0.5}, {100, 80}, {Boundary::walls, Boundary::walls}, 0};
    truth.id = std::move(id);
    truth.position = std::move(position);
    return truth;
}

TEST(LastingIds, HoldUntilAGrainCrossesABoundary) {
    LastingIds ids;
    Snapshot one = frame_of({7, 3}, {{98, 10}, {50, 78}});
    Snapshot two = frame_of({3, 7}, {{51, 79}, {99, 11}});
    Snapshot three = frame_of({7, 3}, {{0.5, 11}, {51, 0.2}});
    ids.renumber(one);
    ids.renumber(two);
    ids.renumber(three);
    EXPECT_THAT(one.id, ElementsAre(7, 3));
    EXPECT_THAT(two.id, ElementsAre(3, 7));
    EXPECT_THAT(three.id, ElementsAre(far + 7, far + 3)) << "in from the other side";
}

TEST(LastingIds, KnowAGrainThatWasOutOfViewForAWhileOnOneSideOnly) {
    LastingIds ids;
    Snapshot seen = frame_of({5}, {{98, 10}});
    Snapshot away = frame_of({}, {});
    Snapshot same_side = frame_of({5}, {{97, 12}});
    Snapshot other_side = frame_of({5}, {{2, 12}});
    ids.renumber(seen);
    ids.renumber(away);
    ids.renumber(same_side);
    ids.renumber(other_side);
    EXPECT_THAT(same_side.id, ElementsAre(5));
    EXPECT_THAT(other_side.id, ElementsAre(far + 5));
}

TEST(LastingIds, LeavePositionsWithoutIdentityAlone) {
    LastingIds ids;
    Snapshot truth = frame_of({}, {{1, 2}});
    ids.renumber(truth);
    EXPECT_TRUE(truth.id.empty());
}

}  // namespace
}  // namespace grainfield::simulate
