#include "io/selected_snapshots.h"

#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield::io {
namespace {

class TenSnapshots : public SnapshotSource {
 public:
    const TrajectoryInfo& info() const override { return info_; }
    std::int64_t count() const override { return 10; }
    Snapshot read(std::int64_t index) override {
        Snapshot snapshot;
        snapshot.frame = index;
        snapshot.time = 0.5 * static_cast<double>(index);
        return snapshot;
    }

 private:
    TrajectoryInfo info_;
};

class TenFields : public FieldSource {
 public:
    std::int64_t count() const override { return 10; }
    FieldFrame read(std::int64_t index) override {
        FieldFrame frame;
        frame.mean_diffusivity = static_cast<double>(index);
        return frame;
    }
};

TEST(SelectedSnapshots, KeepFrameAndTimeOfTheSource) {
    TenSnapshots source;
    SelectedSnapshots selected(source, frame_selection("4::3", 10));
    ASSERT_EQ(selected.count(), 2);
    EXPECT_EQ(selected.read(0).frame, 4);
    EXPECT_EQ(selected.read(1).frame, 7);
    EXPECT_EQ(selected.read(1).time, 3.5);
    EXPECT_EQ(&selected.info(), &source.info());
    EXPECT_THROW(selected.read(2), OptionError);
    EXPECT_THROW(selected.read(-1), OptionError);
}

TEST(SelectedFields, AreCountedFromTheFirstOfTheSelection) {
    TenFields source;
    SelectedFields selected(source, frame_selection("-2:", 10));
    ASSERT_EQ(selected.count(), 2);
    EXPECT_EQ(selected.read(1).mean_diffusivity, 9);
    EXPECT_THROW(selected.read(2), OptionError);
}

}  // namespace
}  // namespace grainfield::io
