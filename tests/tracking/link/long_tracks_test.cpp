#include "tracking/link/long_tracks.h"

#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tests/support/collect.h"

namespace grainfield::tracking {
namespace {

using grainfield::testing::Collect;

Snapshot with_ids(std::int64_t frame, const std::vector<std::int64_t>& ids) {
    Snapshot s;
    s.frame = frame;
    s.id = ids;
    for (const std::int64_t id : ids) {
        s.position.push_back({static_cast<double>(id), static_cast<double>(frame)});
        s.quality.push_back(static_cast<double>(id));
    }
    return s;
}

TEST(LongTracks, ALengthOfOnePassesEverythingOnAtOnce) {
    Collect sink;
    LongTracks filter(sink, 1, 2);
    filter.write(with_ids(0, {4, 7}));
    ASSERT_EQ(sink.snapshots.size(), 1u);
    EXPECT_EQ(sink.snapshots[0].id, (std::vector<std::int64_t>{4, 7}));
    EXPECT_EQ(filter.waiting(), 0u);
}

TEST(LongTracks, LeavesOutShortTracksWithAllTheirColumnsAndKeepsEmptyFrames) {
    Collect sink;
    LongTracks filter(sink, 2, 0);
    filter.write(with_ids(0, {1}));  // only here
    filter.write(with_ids(3, {2, 3}));
    filter.write(with_ids(4, {3}));
    filter.finish();
    ASSERT_EQ(sink.snapshots.size(), 3u);
    EXPECT_TRUE(sink.snapshots[0].position.empty());
    EXPECT_EQ(sink.snapshots[1].frame, 3);
    EXPECT_EQ(sink.snapshots[1].id, std::vector<std::int64_t>{3});
    EXPECT_EQ(sink.snapshots[1].position, (std::vector<Vec2>{{3, 3}}));
    EXPECT_EQ(sink.snapshots[1].quality, std::vector<double>{3});
}

TEST(LongTracks, AGapWithinTheMemoryDoesNotEndATrack) {
    Collect sink;
    LongTracks filter(sink, 2, 1);
    filter.write(with_ids(0, {1}));
    filter.write(with_ids(1, {}));
    EXPECT_TRUE(sink.snapshots.empty());
    filter.write(with_ids(2, {1}));
    EXPECT_EQ(sink.snapshots.size(), 3u);
    EXPECT_EQ(sink.snapshots[0].size(), 1u);
}

TEST(LongTracks, EqualsAFilterThatSawTheWholeVideoAndWaitsNoLongerThanItMust) {
    constexpr int kLength = 4;
    constexpr int kMemory = 2;
    RandomStream random(1, "tracks");
    // Tracks that blink within the memory and end at random.
    std::vector<Snapshot> video;
    std::map<std::int64_t, std::int64_t> times;
    std::map<std::int64_t, std::int64_t> last;  // of tracks alive
    std::int64_t next = 0;
    for (int f = 0; f < 400; ++f) {
        std::vector<std::int64_t> ids;
        std::erase_if(last, [&](const auto& t) { return f - t.second > kMemory + 1; });
        for (auto& [id, when] : last) {
            if (random.uniform() < 0.6) {
                ids.push_back(id);
                when = f;
            }
        }
        for (int n = 0; n < 3; ++n) {
            last[next] = f;
            ids.push_back(next++);
        }
        for (const std::int64_t id : ids) ++times[id];
        video.push_back(with_ids(f, ids));
    }
    Collect sink;
    LongTracks filter(sink, kLength, kMemory);
    for (const Snapshot& s : video) {
        filter.write(s);
        EXPECT_LE(filter.waiting(), static_cast<std::size_t>((kLength - 1) * (kMemory + 1) + 1));
    }
    filter.finish();
    ASSERT_EQ(sink.snapshots.size(), video.size());
    for (std::size_t f = 0; f < video.size(); ++f) {
        std::vector<std::int64_t> expected;
        std::copy_if(video[f].id.begin(), video[f].id.end(), std::back_inserter(expected),
                     [&](std::int64_t id) { return times[id] >= kLength; });
        EXPECT_EQ(sink.snapshots[f].id, expected) << f;
    }
}

TEST(LongTracks, SnapshotsWithoutIdentitiesAreNotTouched) {
    Collect sink;
    LongTracks filter(sink, 5, 0);
    Snapshot s;
    s.position = {{1, 2}};
    filter.write(s);
    ASSERT_EQ(sink.snapshots.size(), 1u);
    EXPECT_EQ(sink.snapshots[0].size(), 1u);
}

}  // namespace
}  // namespace grainfield::tracking
