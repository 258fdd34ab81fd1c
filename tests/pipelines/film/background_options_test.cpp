#include "pipelines/film/background_options.h"

#include <gtest/gtest.h>

#include "core/errors.h"
#include "pipelines/film/film.h"

namespace grainfield::pipelines {
namespace {

BackgroundOptions from(const std::string& text) {
    BackgroundOptions background;
    set_source(background, text);
    return background;
}

TEST(Background, IsOneOfThreeWordsOrAPicture) {
    EXPECT_EQ(from("none").source, BackgroundSource::smooth);
    EXPECT_EQ(from("static").source, BackgroundSource::film);
    EXPECT_EQ(from("running").source, BackgroundSource::running);
    EXPECT_EQ(from("empty.png").source, BackgroundSource::picture);
    EXPECT_EQ(from("empty.png").picture, "empty.png");
    EXPECT_EQ(from("./static").source, BackgroundSource::picture) << "a file of that name";
    EXPECT_THROW(from(""), OptionError);
}

TEST(Background, ForgetsThePictureForAWord) {
    BackgroundOptions background = from("empty.png");
    set_source(background, "running");
    EXPECT_TRUE(background.picture.empty());
}

TEST(Background, OfAFilmIsAPictureThatBelongsToIt) {
    FilmOptions film;
    film.mask = "mask.png";
    film.background_window = 77;
    EXPECT_EQ(pictures_of(film), (std::vector<std::string>{"mask.png"}));
    film.background = "empty.png";
    EXPECT_EQ(pictures_of(film), (std::vector<std::string>{"mask.png", "empty.png"}));
    EXPECT_EQ(background_of(film).window, 77);
}

}  // namespace
}  // namespace grainfield::pipelines
