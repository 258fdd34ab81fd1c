#include "report/maps/overlay.h"

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

TEST(Overlay, OfParticlesOutsideThePictureIsHarmless) {
    Overlay overlay(options());
    const auto& rgb =
        overlay.draw({}, at({{-500, 30}, {1e6, -1e6}, {99, 59}}, {1, 2, 3}), {1, 1, 1});
    EXPECT_EQ(rgb.size(), 3U * 100 * 60);
}

}  // namespace
}  // namespace grainfield::report
