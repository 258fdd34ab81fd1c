#include "pipelines/render/snapshot_window.h"

#include <gtest/gtest.h>

#include "pipelines/validate/stored_snapshots.h"

namespace grainfield::pipelines {
namespace {

/// Counts how often it is read.
class Counted : public StoredSnapshots {
 public:
    explicit Counted(int count) {
        for (int i = 0; i < count; ++i) {
            Snapshot s;
            s.frame = i;
            s.time = 0.1 * i;
            write(s);
        }
    }
    Snapshot read(std::int64_t index) override {
        ++reads;
        return StoredSnapshots::read(index);
    }
    int reads = 0;
};

TEST(SnapshotWindow, HoldsWhatAnExposureReachesAndOneMoreOnEitherSide) {
    Counted source(20);
    SnapshotWindow window(source);
    const auto near = window.around(10, 0.05);
    ASSERT_EQ(near.all.size(), 3U);
    EXPECT_EQ(near.snapshot().frame, 10);
    EXPECT_EQ(near.all.front().frame, 9);
    const auto dense = window.around(10, 0.25);
    ASSERT_EQ(dense.all.size(), 7U);
    EXPECT_EQ(dense.all.front().frame, 7);
    EXPECT_EQ(dense.snapshot().frame, 10);
    const auto first = window.around(0, 0.05);
    EXPECT_EQ(first.all.size(), 2U);
    EXPECT_EQ(first.now, 0U);
    EXPECT_EQ(first.all.back().frame, 1);
    const auto last = window.around(19, 0.05);
    ASSERT_EQ(last.all.size(), 2U);
    EXPECT_EQ(last.all.front().frame, 18);
    EXPECT_EQ(last.all.back().frame, 19);
    EXPECT_EQ(window.around(1, 0.05).all.front().time, 0);
    EXPECT_EQ(window.around(18, 0.05).all.back().frame, 19);
    EXPECT_EQ(window.around(5, 0).all.size(), 1U);
    EXPECT_EQ(window.around(5, 0).snapshot().frame, 5);
}

TEST(SnapshotWindow, ReadsInOrderOnce) {
    Counted source(20);
    SnapshotWindow window(source);
    for (std::int64_t i = 0; i < 20; ++i) {
        EXPECT_EQ(window.around(i, 0.05).snapshot().frame, i);
    }
    EXPECT_EQ(source.reads, 20);
}

}  // namespace
}  // namespace grainfield::pipelines
