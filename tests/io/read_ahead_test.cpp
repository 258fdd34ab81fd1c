#include "io/read_ahead.h"

#include <atomic>

#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield::io {
namespace {

/// Frames whose index is their content; counts how often it is read, and refuses one.
class Counting : public FrameSource {
 public:
    explicit Counting(std::atomic<int>& reads, std::int64_t bad = -1) : reads_(reads), bad_(bad) {}
    std::int64_t count() const override { return 6; }
    int width() const override { return 1; }
    int height() const override { return 1; }
    int bit_depth() const override { return 8; }
    std::optional<double> frame_rate() const override { return 25.0; }
    Frame read(std::int64_t index) override {
        const bool alone = busy_.exchange(true) == false;
        EXPECT_TRUE(alone) << "two threads in one source";
        ++reads_;
        Frame frame;
        frame.index = index;
        frame.image = Image(1, 1, static_cast<float>(index));
        busy_ = false;
        if (index == bad_) throw InputError({"frame cannot be read", "3", "a frame", ""});
        return frame;
    }
    std::string name() const override { return "counting"; }
    const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
    std::atomic<int>& reads_;
    std::int64_t bad_;
    std::atomic<bool> busy_ = false;
    std::vector<std::string> warnings_;
};

TEST(ReadAhead, GivesTheSameFramesInAnyOrder) {
    std::atomic<int> reads = 0;
    const auto frames = read_ahead(std::make_unique<Counting>(reads));
    for (const std::int64_t i : {0, 1, 2, 5, 0, 0, 3, 4, 2}) {
        const Frame frame = frames->read(i);
        EXPECT_EQ(frame.index, i);
        EXPECT_EQ(frame.image(0, 0), static_cast<float>(i));
    }
    EXPECT_EQ(frames->frame_rate(), 25.0);
}

TEST(ReadAhead, ReadsEachFrameOnceWhenTheyAreTakenInOrder) {
    std::atomic<int> reads = 0;
    const auto frames = read_ahead(std::make_unique<Counting>(reads));
    for (std::int64_t i = 0; i < 6; ++i) frames->read(i);
    EXPECT_EQ(reads, 6);
}

TEST(ReadAhead, ReadsNothingThatIsNotAskedForWhereFramesAreTakenHereAndThere) {
    std::atomic<int> reads = 0;
    const auto frames = read_ahead(std::make_unique<Counting>(reads));
    for (const std::int64_t i : {4, 1, 3, 0}) frames->read(i);
    frames->read(5);  // waits for what is under way
    EXPECT_EQ(reads, 5);
}

TEST(ReadAhead, ThrowsWhenTheBadFrameIsAskedForNotBefore) {
    std::atomic<int> reads = 0;
    const auto frames = read_ahead(std::make_unique<Counting>(reads, 3));
    for (const std::int64_t i : {0, 1, 2}) EXPECT_NO_THROW(frames->read(i));
    EXPECT_THROW(frames->read(3), InputError);
    EXPECT_NO_THROW(frames->read(2));
    EXPECT_NO_THROW(frames->read(4));
}

}  // namespace
}  // namespace grainfield::io
