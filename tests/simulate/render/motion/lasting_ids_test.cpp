#include "simulate/render/motion/lasting_ids.h"

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

const Vec2 kFrame{100, 80};

/// Follows the frames and renumbers them afterwards, the last one first.
void renumber(std::vector<Snapshot*> frames) {
    LastingIds ids(kFrame);
    for (const Snapshot* f : frames) ids.follow(*f);
    for (std::size_t i = frames.size(); i-- > 0;) {
        ids.renumber(*frames[i], static_cast<std::int64_t>(i));
    }
}

TEST(LastingIds, HoldUntilAGrainCrossesABoundary) {
    Snapshot one = frame_of({7, 3}, {{98, 10}, {50, 78}});
    Snapshot two = frame_of({3, 7}, {{51, 79}, {99, 11}});
    Snapshot three = frame_of({7, 3}, {{0.5, 11}, {51, 0.2}});
    Snapshot four = frame_of({7, 3}, {{99.5, 11}, {51, 0.3}});
    renumber({&one, &two, &three, &four});
    EXPECT_THAT(one.id, ElementsAre(7, 3));
    EXPECT_THAT(two.id, ElementsAre(3, 7));
    EXPECT_THAT(three.id, ElementsAre(far + 7, far + 3)) << "in from the other side";
    EXPECT_THAT(four.id, ElementsAre(2 * far + 7, far + 3)) << "and back";
}

TEST(LastingIds, KnowAGrainThatWasOutOfViewForAWhileOnOneSideOnly) {
    Snapshot seen = frame_of({5}, {{98, 10}});
    Snapshot away = frame_of({}, {});
    Snapshot same_side = frame_of({5}, {{97, 12}});
    Snapshot other_side = frame_of({5}, {{2, 12}});
    renumber({&seen, &away, &same_side, &other_side});
    EXPECT_THAT(same_side.id, ElementsAre(5));
    EXPECT_THAT(other_side.id, ElementsAre(far + 5));
}

TEST(LastingIds, LeavePositionsWithoutIdentityAlone) {
    Snapshot truth = frame_of({}, {{1, 2}});
    renumber({&truth});
    EXPECT_TRUE(truth.id.empty());
}

// A frame that shows two periods: a crossing is a step of half of the frame only.
TEST(Continuity, ABoundaryWithinTheFrameIsCrossedToo) {
    Continuity frame(kFrame, Absence::keeps);
    Continuity period({50, 80}, Absence::keeps);
    for (Continuity* c : {&frame, &period}) {
        EXPECT_THAT(c->follow({1}, {{49, 5}}), ElementsAre(Sighting::first));
    }
    EXPECT_THAT(frame.follow({1}, {{0.5, 5}}), ElementsAre(Sighting::same));
    EXPECT_THAT(period.follow({1}, {{0.5, 5}}), ElementsAre(Sighting::another));
}

TEST(Continuity, WhoWasAwayIsAnotherOneOnlyForThoseWhoCannotKnow) {
    Continuity keeps(kFrame, Absence::keeps);
    Continuity ends(kFrame, Absence::ends);
    for (Continuity* c : {&keeps, &ends}) {
        c->follow({1, 2}, {{10, 5}, {20, 5}});
        c->follow({2}, {{21, 5}});
    }
    EXPECT_THAT(keeps.follow({1, 2}, {{11, 5}, {22, 5}}),
                ElementsAre(Sighting::same, Sighting::same));
    EXPECT_THAT(ends.follow({1, 2}, {{11, 5}, {22, 5}}),
                ElementsAre(Sighting::another, Sighting::same));
}

}  // namespace
}  // namespace grainfield::simulate
