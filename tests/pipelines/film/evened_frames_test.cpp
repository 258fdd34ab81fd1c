#include "pipelines/film/evened_frames.h"

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "core/memory_frames.h"
#include "core/support/random.h"

namespace grainfield::pipelines {
namespace {

constexpr int kFrames = 60;
const tracking::FilmLevels kLevels{
    .sign = 1, .core = 30, .contrast = 170, .noise = 3.4, .reach = 4};

/// A film behind a speck that fades from frame to frame; frames 21 to 33 repeat number 20, across
/// three estimates, and 45 repeats 44.
std::unique_ptr<FrameSource> film() {
    RandomStream random(3, "evened frames");
    std::vector<Image> images;
    for (int f = 0; f < kFrames; ++f) {
        if ((f > 20 && f < 34) || f == 45) {
            images.push_back(images.back());
            continue;
        }
        Image image(64, 48);
        for (int y = 0; y < 48; ++y) {
            for (int x = 0; x < 64; ++x) {
                const double speck = std::hypot(x - 30, y - 20) < 6 ? 0.5 + 0.3 * f / kFrames : 1.0;
                const double light = random.uniform() < 0.3 ? 0 : speck;
                image(x, y) =
                    static_cast<float>(std::round(30 + 170 * light + 3.4 * random.normal()));
            }
        }
        images.push_back(std::move(image));
    }
    return std::make_unique<MemoryFrames>(images);
}

EvenedFrames evened(std::int64_t window, const tracking::VisiblePixels& visible = {}) {
    return {film(),
            {.source = BackgroundSource::running, .picture = {}, .frames = 20, .window = window},
            kLevels,
            visible,
            1};
}

TEST(EvenedFrames, WhatRepeatsTheFrameBeforeStillDoesWithARunningBackground) {
    EvenedFrames frames = evened(12);
    ASSERT_TRUE(frames.is_running());
    const auto source = film();
    Image before;
    int repeats = 0;
    for (int f = 0; f < kFrames; ++f) {
        const Image image = frames.read(f).image;
        const bool is_repeated = f > 0 && source->read(f).image == source->read(f - 1).image;
        repeats += is_repeated;
        EXPECT_EQ(image == before, is_repeated) << f;
        before = image;
    }
    EXPECT_EQ(repeats, 14);
}

TEST(EvenedFrames, AFrameIsTheSameInWhateverOrderFramesAreRead) {
    EvenedFrames in_order = evened(12);
    std::vector<Image> images;
    for (int f = 0; f < kFrames; ++f) images.push_back(in_order.read(f).image);
    for (const int f : {33, 28, 21, 20, 45, 30, 31, 59, 0, 34}) {
        EvenedFrames fresh = evened(12);
        EXPECT_EQ(fresh.read(f).image, images[static_cast<std::size_t>(f)]) << f;
        EXPECT_EQ(in_order.read(f).image, images[static_cast<std::size_t>(f)]) << f;
    }
}

TEST(EvenedFrames, AFilmThatIsNotLongerThanTheWindowHasOneBackground) {
    EXPECT_FALSE(evened(kFrames).is_running());
    EXPECT_TRUE(evened(kFrames - 1).is_running());
}

TEST(EvenedFrames, WhatAMaskHidesIsLeftAsItIs) {
    Image mask(64, 48, 1);
    for (int y = 10; y < 30; ++y) {
        for (int x = 20; x < 40; ++x) mask(x, y) = 0;
    }
    for (const std::int64_t window : {12, 1000}) {
        const Image image = evened(window, tracking::VisiblePixels(mask)).read(5).image;
        const Image raw = film()->read(5).image;
        EXPECT_EQ(image(30, 20), raw(30, 20));
        EXPECT_NE(evened(window).read(5).image(30, 20), raw(30, 20));
    }
}

}  // namespace
}  // namespace grainfield::pipelines
