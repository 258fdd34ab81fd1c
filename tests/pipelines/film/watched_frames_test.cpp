#include "pipelines/film/watched_frames.h"

#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield::pipelines {
namespace {

/// Five frames of which number 3 is corrupt.
class FiveFrames : public FrameSource {
 public:
    explicit FiveFrames(std::vector<std::string> warnings = {}) : warnings_(std::move(warnings)) {}
    std::int64_t count() const override { return 5; }
    int width() const override { return 4; }
    int height() const override { return 3; }
    int bit_depth() const override { return 8; }
    std::optional<double> frame_rate() const override { return std::nullopt; }
    Frame read(std::int64_t index) override {
        Frame frame;
        frame.index = index;
        if (index == 3) {
            frame.status = FrameStatus::corrupt;
            frame.message = "checksum";
        }
        return frame;
    }
    std::string name() const override { return "five"; }
    const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
    std::vector<std::string> warnings_;
};

std::vector<std::int64_t> taken(PreviewChoice choice, const std::vector<std::int64_t>& positions) {
    std::vector<std::int64_t> kept;
    for (const std::int64_t p : positions) {
        if (choice.takes(p)) kept.push_back(p);
    }
    return kept;
}

TEST(WatchedFrames, PassBadFramesThroughUnlessTheyAreRefused) {
    WatchedFrames lenient(std::make_unique<FiveFrames>(), BadFrames::allow);
    EXPECT_EQ(lenient.read(3).status, FrameStatus::corrupt);
    WatchedFrames strict(std::make_unique<FiveFrames>(), BadFrames::refuse);
    EXPECT_EQ(strict.read(2).status, FrameStatus::ok);
    EXPECT_THROW(strict.read(3), InputError);
}

TEST(WatchedFrames, RefusingBadFramesRefusesInputsThatOpenWithAWarning) {
    EXPECT_THROW(WatchedFrames(std::make_unique<FiveFrames>(std::vector<std::string>{"truncated"}),
                               BadFrames::refuse),
                 InputError);
    EXPECT_NO_THROW(WatchedFrames(
        std::make_unique<FiveFrames>(std::vector<std::string>{"truncated"}), BadFrames::allow));
}

TEST(PreviewChoice, TakesFirstMiddleAndLastOfThree) {
    EXPECT_EQ(taken({3, 5}, {0, 1, 2, 3, 4}), (std::vector<std::int64_t>{0, 2, 4}));
    EXPECT_EQ(taken({3, 1000}, {0, 499, 500, 999}), (std::vector<std::int64_t>{0, 499, 999}));
}

TEST(PreviewChoice, TakesTheNextGoodFrameInPlaceOfABadOne) {
    EXPECT_EQ(taken({3, 5}, {1, 3, 4}), (std::vector<std::int64_t>{1, 3, 4}));
    EXPECT_EQ(taken({3, 5}, {3}), (std::vector<std::int64_t>{3}));
}

TEST(PreviewChoice, LeavesFramesBeforeAPartToOthers) {
    PreviewChoice part(3, 9);  // 0, 4, 8
    part.begin_at(3);
    EXPECT_EQ(taken(part, {3, 4, 5}), (std::vector<std::int64_t>{4}));
}

TEST(PreviewChoice, TakesNoMoreThanThereAreAndNoneIfNoneAreWanted) {
    EXPECT_EQ(taken({3, 1}, {0}), (std::vector<std::int64_t>{0}));
    EXPECT_EQ(taken({1, 4}, {0, 1, 2, 3}), (std::vector<std::int64_t>{0}));
    EXPECT_TRUE(taken({0, 4}, {0, 1, 2, 3}).empty());
    EXPECT_TRUE(taken({3, 0}, {}).empty());
}

}  // namespace
}  // namespace grainfield::pipelines
