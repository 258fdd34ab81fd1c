#include "app/plain_frames.h"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "app/stored_snapshots.h"
#include "tracking/calibrate/calibration.h"

namespace grainfield::app {
namespace {

StoredSnapshots one_sphere(Vec2 at) {
    StoredSnapshots trajectory;
    Snapshot s;
    s.box = {{0, 0}, {10, 10}, {}, 1.84};
    s.position = {at, {30, 3}};
    s.id = {7, 8};
    s.z = {1.2, 0.6};
    trajectory.write(s);
    return trajectory;
}

PlainFrameOptions noiseless(double scale) {
    PlainFrameOptions options;
    options.width = options.height = 96;
    options.scale = scale;
    options.electrons = 1e9;
    options.read_noise = 0;
    options.vignetting = 0;
    options.exposure = 1;
    return options;
}

TEST(PlainFrames, ShowASphereWhereTheTruthSaysWithoutPixelLocking) {
    for (double offset = 0; offset < 0.05; offset += 0.011) {
        StoredSnapshots trajectory = one_sphere({5 + offset, 5 - 0.7 * offset});
        PlainFrames frames(trajectory, noiseless(20), 1, 2);
        const Snapshot truth = frames.truth(0);
        ASSERT_EQ(truth.size(), 1U) << "the other one is out of sight";
        EXPECT_EQ(truth.id[0], 7);
        EXPECT_EQ(truth.layer[0], Layer::top);
        const Image image = frames.read(0).image;
        Vec2 centre;
        double mass = 0;
        for (int y = 0; y < 96; ++y) {
            for (int x = 0; x < 96; ++x) {
                const double dark = 255 - static_cast<double>(image(x, y));
                centre += dark * Vec2{x + 0.0, y + 0.0};
                mass += dark;
            }
        }
        // Rounding to 8 bits on 300 pixels of the edge: 0.3 · √300 · 10/mass ≈ 0.001 px.
        EXPECT_NEAR(centre.x / mass, truth.position[0].x, 0.004);
        EXPECT_NEAR(centre.y / mass, truth.position[0].y, 0.004);
    }
}

TEST(PlainFrames, HaveTheDarknessProfileOfAMirrorSphere) {
    StoredSnapshots trajectory = one_sphere({5, 5});
    PlainFrames frames(trajectory, noiseless(24), 1, 1);
    const Image image = frames.read(0).image;
    const Vec2 c = frames.truth(0).position[0];
    // Mirror-sphere profile of physics §5, radii in px of a = 10.09 px.
    const std::vector<std::pair<double, double>> profile{{2.25, .974}, {3.25, .838}, {4.25, .562},
                                                         {4.75, .394}, {5.25, .230}, {6.25, .036}};
    for (int x = 54; x <= 62; ++x) {
        const double r = norm(Vec2{x - c.x, 47 - c.y}) / 24 * 10.09;
        const double darkness = (1 - static_cast<double>(image(x, 47)) / 255) / 0.97;
        std::size_t i = 1;
        while (profile[i].first < r) ++i;
        const auto& [r0, d0] = profile[i - 1];
        const auto& [r1, d1] = profile[i];
        // The table is rounded and curved between its rows.
        EXPECT_NEAR(darkness, d0 + (d1 - d0) * (r - r0) / (r1 - r0), 0.05) << r;
    }
}

TEST(PlainFrames, DoNotDependOnTheNumberOfThreadsButOnTheSeed) {
    StoredSnapshots trajectory = one_sphere({5, 5});
    PlainFrameOptions options;
    options.width = options.height = 200;
    const Image one = PlainFrames(trajectory, options, 5, 1).read(0).image;
    EXPECT_EQ(one, PlainFrames(trajectory, options, 5, 4).read(0).image);
    EXPECT_NE(one, PlainFrames(trajectory, options, 6, 1).read(0).image);
}

}  // namespace
}  // namespace grainfield::app
