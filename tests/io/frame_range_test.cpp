#include "io/frame_range.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield::io {
namespace {

class TenFrames : public FrameSource {
 public:
    std::int64_t count() const override { return 10; }
    int width() const override { return 1; }
    int height() const override { return 1; }
    int bit_depth() const override { return 8; }
    std::optional<double> frame_rate() const override { return 50; }
    std::string name() const override { return "ten"; }
    const std::vector<std::string>& warnings() const override { return warnings_; }
    Frame read(std::int64_t index) override {
        Frame frame;
        frame.index = index;
        frame.time = static_cast<double>(index) / 50;
        return frame;
    }

 private:
    std::vector<std::string> warnings_;
};

std::vector<std::int64_t> indices(std::string_view range) {
    const auto frames = select_frames(std::make_unique<TenFrames>(), range);
    std::vector<std::int64_t> result;
    for (std::int64_t i = 0; i < frames->count(); ++i) result.push_back(frames->read(i).index);
    return result;
}

TEST(FrameRange, SelectsLikeAPythonSlice) {
    using ::testing::ElementsAre;
    EXPECT_EQ(indices("").size(), 10U);
    EXPECT_EQ(indices("::").size(), 10U);
    EXPECT_THAT(indices("2:5"), ElementsAre(2, 3, 4));
    EXPECT_THAT(indices("::4"), ElementsAre(0, 4, 8));
    EXPECT_THAT(indices("1::4"), ElementsAre(1, 5, 9));
    EXPECT_THAT(indices("-3:"), ElementsAre(7, 8, 9));
    EXPECT_THAT(indices(":-8"), ElementsAre(0, 1));
    EXPECT_THAT(indices("8:100"), ElementsAre(8, 9));
    EXPECT_THAT(indices("-100:1"), ElementsAre(0));
    EXPECT_THAT(indices("7"), ElementsAre(7));
    EXPECT_THAT(indices("-1"), ElementsAre(9));
    EXPECT_THAT(indices("0:10:9223372036854775807"), ElementsAre(0));
    EXPECT_THAT(indices("-9223372036854775808:2"), ElementsAre(0, 1));
}

TEST(FrameRange, InWordsHasNoColon) {
    EXPECT_EQ(in_words(""), "all frames");
    EXPECT_EQ(in_words("::"), "all frames");
    EXPECT_EQ(in_words("7"), "frame 7");
    EXPECT_EQ(in_words("50:"), "frames from 50");
    EXPECT_EQ(in_words(":100"), "frames 0 to 99");
    EXPECT_EQ(in_words(" 100:200 "), "frames 100 to 199");
    EXPECT_EQ(in_words(":1"), "frame 0");
    EXPECT_EQ(in_words("-1:"), "last frame");
    EXPECT_EQ(in_words("-50:"), "last 50 frames");
    EXPECT_EQ(in_words("::4"), "frames in steps of 4");
    EXPECT_EQ(in_words("10:50:5"), "frames 10 to 49 in steps of 5");
    EXPECT_EQ(in_words("-9223372036854775808:"), "last 9223372036854775808 frames");
    // From both ends it takes the number of frames to say more.
    EXPECT_EQ(in_words("5:-5"), "frames 5:-5");
    EXPECT_THROW(in_words("a:b"), OptionError);
}

TEST(FrameRange, KeepsIndexAndTimeOfTheSource) {
    const auto frames = select_frames(std::make_unique<TenFrames>(), "4::3");
    EXPECT_EQ(frames->read(1).index, 7);
    EXPECT_DOUBLE_EQ(frames->read(1).time, 0.14);
    EXPECT_THROW(frames->read(2), OptionError);
    EXPECT_THROW(frames->read(-1), OptionError);
}

TEST(FrameRange, RefusesWhatIsNoRangeOrEmpty) {
    for (const char* bad : {"a", "1:2:3:4", "5:5", "6:2", "::0", "::-1", "1.5:", "10", "-11", "1 2",
                            "99999999999999999999:"}) {
        EXPECT_THROW(indices(bad), OptionError) << bad;
    }
}

TEST(FrameRange, APartStandsAmongTheFramesOfItsFilm) {
    const FilmPart all = part_of_film("4:8", "", 10);
    EXPECT_EQ(all.film, (FrameSelection{0, 1, 10}));
    EXPECT_EQ(all.span, (FrameSpan{4, 8}));
    const FilmPart steps = part_of_film("4::3", "", 10);
    EXPECT_EQ(steps.film, (FrameSelection{1, 3, 3})) << "frames 1, 4, 7";
    EXPECT_EQ(steps.span, (FrameSpan{1, 3}));
    const FilmPart within = part_of_film("6:8:2", "2:9:2", 10);
    EXPECT_EQ(within.film, (FrameSelection{2, 2, 4})) << "frames 2, 4, 6, 8";
    EXPECT_EQ(within.span, (FrameSpan{2, 3}));
    EXPECT_EQ(part_of_film("8", "2:9:2", 10).span, (FrameSpan{3, 4})) << "one frame has no step";
}

TEST(FrameRange, FramesThatTheFilmHasNotAreNoPartOfIt) {
    EXPECT_THROW(part_of_film("0:5", "2:", 10), OptionError);
    EXPECT_THROW(part_of_film("5:10", "2:9", 10), OptionError);
    EXPECT_THROW(part_of_film("3:9:2", "2::2", 10), OptionError);
    EXPECT_THROW(part_of_film("2:9:4", "2::2", 10), OptionError);
}

}  // namespace
}  // namespace grainfield::io
