#include "report/maps/overlay.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "report/figures/colours.h"

namespace grainfield::report {
namespace {

OverlayOptions options() {
    OverlayOptions o;
    o.trail = 3;
    o.diameter = 20;
    o.x = {-0.5, 99.5};
    o.y = {-0.5, 59.5};
    o.width = 100;
    o.height = 60;
    return o;
}

Colour pixel(const std::vector<std::uint8_t>& rgb, int x, int y) {
    const auto at = 3 * (static_cast<std::size_t>(y) * 100 + static_cast<std::size_t>(x));
    return {rgb[at], rgb[at + 1], rgb[at + 2]};
}

Snapshot at(std::vector<Vec2> positions, std::vector<std::int64_t> ids = {}) {
    Snapshot snapshot;
    snapshot.position = std::move(positions);
    snapshot.id = std::move(ids);
    return snapshot;
}

TEST(Overlay, FillsDiscsInTheColourOfTheirOrderWhereThereIsNoFilm) {
    Overlay overlay(options());
    const auto rgb = overlay.draw({}, at({{30, 20}, {70, 40}}), {1.0, std::nan("")});
    EXPECT_EQ(pixel(rgb, 30, 20), viridis(1));
    EXPECT_EQ(pixel(rgb, 37, 20), viridis(1)) << "radius 8.5 px: 85 % of the diameter";
    EXPECT_EQ(pixel(rgb, 40, 20), (Colour{255, 255, 255}));
    EXPECT_EQ(pixel(rgb, 70, 40), viridis(std::nan("")));
}

TEST(Overlay, LeavesTheFilmVisibleInsideTheRings) {
    Image image(100, 60, 100);
    for (int x = 0; x < 100; ++x) image(x, 0) = 200;
    Overlay overlay(options());
    const auto rgb = overlay.draw(image, at({{30, 20}}), {0.5});
    EXPECT_EQ(pixel(rgb, 30, 20), (Colour{0, 0, 0})) << "the darkest count";
    EXPECT_EQ(pixel(rgb, 90, 0), (Colour{255, 255, 255}));
    EXPECT_EQ(pixel(rgb, 37, 20), viridis(0.5)) << "the ring";
}

TEST(Overlay, TurnsSimulationsUpright) {
    OverlayOptions o = options();
    o.y_down = false;
    Overlay overlay(o);
    const auto rgb = overlay.draw({}, at({{30, 10}}), {0});
    EXPECT_EQ(pixel(rgb, 30, 49), viridis(0));
    EXPECT_EQ(pixel(rgb, 30, 10), (Colour{255, 255, 255}));
}

TEST(Overlay, DrawsTrailsOfIdentitiesAndForgetsThem) {
    Overlay overlay(options());
    const auto is_trail = [](Colour c) { return c[0] > 200 && c[2] < 100; };
    overlay.draw({}, at({{20, 30}}, {7}), {std::nan("")});
    auto rgb = overlay.draw({}, at({{50, 30}}, {7}), {std::nan("")});
    EXPECT_TRUE(is_trail(pixel(rgb, 35, 30))) << "between both places";
    // 50 px are more than two diameters: no trail across.
    rgb = overlay.draw({}, at({{95, 30}}, {7}), {std::nan("")});
    EXPECT_FALSE(is_trail(pixel(rgb, 75, 30)));
    // A particle without identity leaves none.
    Overlay unlinked(options());
    unlinked.draw({}, at({{20, 30}}, {-1}), {});
    EXPECT_FALSE(is_trail(pixel(unlinked.draw({}, at({{50, 30}}, {-1}), {}), 35, 30)));
}

TEST(Overlay, KeepsAtMostTheLengthOfATrail) {
    Overlay overlay(options());
    std::vector<std::uint8_t> rgb;
    for (int i = 0; i < 8; ++i) rgb = overlay.draw({}, at({{10.0 + 10 * i, 30}}, {1}), {});
    const auto is_trail = [](Colour c) { return c[0] > 200 && c[2] < 100; };
    EXPECT_TRUE(is_trail(pixel(rgb, 55, 30))) << "three steps of 10 px back from 80";
    EXPECT_FALSE(is_trail(pixel(rgb, 45, 30)));
}

/// Pixels of the strip that are neither its paper nor grey: those of the colour key.
std::vector<Colour> key_colours(const Overlay& overlay, const std::vector<std::uint8_t>& rgb,
                                int above) {
    std::vector<Colour> colours;
    for (int y = above; y < overlay.height(); ++y) {
        for (int x = 0; x < overlay.width(); ++x) {
            const auto at = 3 * static_cast<std::size_t>(y * overlay.width() + x);
            const Colour c{rgb[at], rgb[at + 1], rgb[at + 2]};
            if (c[0] == c[1] && c[1] == c[2]) continue;
            if (std::find(colours.begin(), colours.end(), c) == colours.end()) colours.push_back(c);
        }
    }
    return colours;
}

TEST(Overlay, AStripBelowThePictureHasCaptionAndColourKey) {
    for (const int width : {300, 900}) {
        OverlayOptions o = options();
        o.width = width;
        o.x = {-0.5, width - 0.5};
        o.has_strip = true;
        o.key = {.title = "speed (px/frame)", .low = 0, .high = 2.5};
        Overlay overlay(o);
        const auto plain = overlay.draw({}, at({{30, 20}}), {2.5}, "");
        const auto rgb = overlay.draw({}, at({{30, 20}}), {2.5}, "frame 12  0.48 s");
        ASSERT_GT(overlay.height(), 60 + 10);
        ASSERT_EQ(rgb.size(), static_cast<std::size_t>(3 * width * overlay.height()));
        const auto at_pixel = [&](int x, int y) {
            return 3 * static_cast<std::size_t>(y * width + x);
        };
        EXPECT_EQ(rgb[at_pixel(30, 20)], viridis(1)[0]) << "2.5 is the end of the range";
        EXPECT_NE(plain, rgb) << "the caption is written";
        const std::vector<Colour> key = key_colours(overlay, rgb, 60);
        EXPECT_GT(key.size(), 50U);
        EXPECT_NE(std::find(key.begin(), key.end(), viridis(0)), key.end());
        EXPECT_NE(std::find(key.begin(), key.end(), viridis(1)), key.end());
    }
}

TEST(Overlay, ClassesHaveAColourEach) {
    OverlayOptions o = options();
    o.has_strip = true;
    o.key = {.title = "layer", .classes = {"bottom", "top"}};
    Overlay overlay(o);
    const auto rgb =
        overlay.draw({}, at({{20, 20}, {50, 20}, {80, 20}}), {0, 1, std::nan("")}, "x");
    EXPECT_EQ(pixel(rgb, 20, 20), distinct_colour(0, 2));
    EXPECT_EQ(pixel(rgb, 50, 20), distinct_colour(1, 2));
    EXPECT_EQ(pixel(rgb, 80, 20), viridis(std::nan(""))) << "not known";
    EXPECT_EQ(key_colours(overlay, rgb, 60).size(), 2U);
    // What is in no class has a grey square where it has a name.
    const auto longest_grey_row = [&](const std::vector<std::uint8_t>& drawn) {
        int longest = 0;
        int run = 0;
        for (std::size_t p = 3UL * 60 * 100; p < drawn.size(); p += 3) {
            run = pixel(drawn, static_cast<int>(p / 3 % 100), static_cast<int>(p / 300)) ==
                          viridis(std::nan(""))
                      ? run + 1
                      : 0;
            longest = std::max(longest, run);
        }
        return longest;
    };
    EXPECT_LT(longest_grey_row(rgb), 4);
    o.key.other = "unknown";
    Overlay named(o);
    EXPECT_GT(longest_grey_row(named.draw({}, at({{20, 20}}), {0}, "x")), 5);
}

TEST(Overlay, OfParticlesOutsideThePictureIsHarmless) {
    Overlay overlay(options());
    const auto& rgb =
        overlay.draw({}, at({{-500, 30}, {1e6, -1e6}, {99, 59}}, {1, 2, 3}), {1, 1, 1});
    EXPECT_EQ(rgb.size(), 3U * 100 * 60);
}

}  // namespace
}  // namespace grainfield::report
