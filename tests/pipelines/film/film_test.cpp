#include "pipelines/film/film.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/io/seq_writer.h"
#include "tests/support/disc_sequence.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::pipelines {
namespace {

using ::testing::HasSubstr;

/// The defaults, changed.
template <class Change>
FilmOptions with(const Change& change) {
    FilmOptions options;
    change(options);
    return options;
}

class OpenFilm : public ::testing::Test {
 protected:
    Film open(const FilmOptions& options = {}) {
        job_.inputs.assign(paths_.begin(), paths_.end());
        tracking::TrackOptions tracking;
        tracking.threads = 1;
        return open_film(job_, options, tracking);
    }

    testing::ScratchFolder folder_;
    const std::vector<std::string> paths_ = testing::write_disc_sequence(folder_, 4);
    Job job_;
};

TEST_F(OpenFilm, ARegionIsThatPartOfEveryFrameAndSaysWhereItLies) {
    const Image whole = open().frames->read(1).image;
    const Film part = open(with([](auto& o) { o.region = {30, 20, 100, 80}; }));
    EXPECT_EQ(part.origin, (Vec2{30, 20}));
    const Image image = part.frames->read(1).image;
    ASSERT_EQ(image.width(), 100);
    ASSERT_EQ(image.height(), 80);
    for (const int x : {0, 50, 99}) EXPECT_EQ(image(x, 7), whole(x + 30, 27));
}

TEST_F(OpenFilm, SelectsFramesThatKeepTheirIndices) {
    const Film film = open(with([](auto& o) { o.fps = 50, o.frames = "1::2"; }));
    ASSERT_EQ(film.frames->count(), 2);
    EXPECT_EQ(film.frames->read(1).index, 3);
    EXPECT_DOUBLE_EQ(film.frames->read(1).time, 0.06);
    EXPECT_EQ(film.frames->frame_rate(), 50.0);
}

TEST_F(OpenFilm, TheMosaicOfASequenceIsNoDoubtOnceItsFilterIsNamed) {
    testing::ScratchFolder scratch;
    const std::string path = scratch / "film.seq";
    io::picture_files::write_content(path, io::SeqWriter{.format = 101}.text(4));
    job_.inputs = {path};
    FilmOptions options = with([](auto& o) { o.strict = true; });
    EXPECT_THROW(open_film(job_, options, {}), InputError);
    options.mosaic = io::ColourFilter::rggb;
    EXPECT_EQ(open_film(job_, options, {}).frames->count(), 4);
}

TEST_F(OpenFilm, ABadFrameIsPassedOnUnlessAskedToBeStrict) {
    testing::truncate_file(paths_[2], 0.4);
    EXPECT_EQ(open().frames->read(2).status, FrameStatus::corrupt);
    const Film strict = open(with([](auto& o) { o.strict = true; }));
    EXPECT_EQ(strict.frames->read(1).status, FrameStatus::ok);
    EXPECT_THROW(strict.frames->read(2), InputError);
}

TEST_F(OpenFilm, AMaskHidesWhatIsZeroInIt) {
    Image mask(testing::kPictureSize, testing::kPictureSize, 255);
    for (int x = 0; x < 40; ++x) mask(x, 9) = 0;
    testing::write_png(folder_ / "mask.png", mask);
    const Film film = open(with([&](auto& o) { o.mask = folder_ / "mask.png"; }));
    EXPECT_FALSE(film.visible(39, 9));
    EXPECT_TRUE(film.visible(40, 9));
    EXPECT_THAT(job_.plan.text(), HasSubstr("run  mask: 0.1 % of the pixels"));
    testing::write_png(folder_ / "mask.png", Image(testing::kPictureSize, 3, 255));
    EXPECT_THROW(open(with([&](auto& o) { o.mask = folder_ / "mask.png"; })), InputError);
}

TEST_F(OpenFilm, AStaticBackgroundNeedsThreeFrames) {
    const Film film = open(with([](auto& o) { o.frames = ":2", o.background = "static"; }));
    EXPECT_EQ(film.frames->read(0).image,
              open(with([](auto& o) { o.frames = ":2"; })).frames->read(0).image);
    ASSERT_EQ(job_.plan.skipped().size(), 1U);
    EXPECT_EQ(job_.plan.skipped()[0].reason, "fewer than three frames");
}

TEST_F(OpenFilm, TheLightIsNotCorrectedTwice) {
    const Image flat(testing::kPictureSize, testing::kPictureSize, 200);
    testing::write_png(folder_ / "flat.png", flat);
    const std::string picture = folder_ / "flat.png";
    EXPECT_THROW(open(with([&](auto& o) { o.flat_field = o.background = picture; })), OptionError);
    EXPECT_EQ(pictures_of(with([&](auto& o) { o.flat_field = picture, o.background = "static"; })),
              std::vector<std::string>{picture});
}

}  // namespace
}  // namespace grainfield::pipelines
