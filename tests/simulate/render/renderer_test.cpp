#include "simulate/render/renderer.h"

#include <cmath>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/simulate/render/render_scenes.h"

namespace grainfield::simulate {
namespace {

TrajectoryInfo md_info() {
    TrajectoryInfo info;
    info.origin = Origin::md;
    info.time_unit = TimeUnit::sqrt_a_over_g;
    return info;
}

Snapshot snapshot_of(const SphereScene& scene, double side, Boundary boundary = Boundary::walls) {
    Snapshot s;
    s.box = square_box(side, boundary);
    for (std::size_t i = 0; i < scene.centre.size(); ++i) {
        s.position.push_back({scene.centre[i].x, scene.centre[i].y});
        s.z.push_back(scene.centre[i].z);
        s.id.push_back(static_cast<std::int64_t>(i));
    }
    return s;
}

RenderOptions ideal(int pixels) {
    RenderOptions o;
    o.camera = CameraKind::ideal;
    o.view.width = pixels;
    o.view.height = pixels;
    o.sensor.bits = 16;
    return o;
}

// Centre of the darkness of a frame.
Vec2 centroid(const Image& image) {
    float bright = 0;
    for (const float v : image.pixels()) bright = std::max(bright, v);
    double sum = 0;
    Vec2 moment;
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            const double dark = static_cast<double>(bright - image(x, y));
            sum += dark;
            moment += dark * Vec2{static_cast<double>(x), static_cast<double>(y)};
        }
    }
    return moment * (1 / sum);
}

TEST(Renderer, TruthIsTheCentroidOfTheDarkness) {
    for (const Projection projection : {Projection::telecentric, Projection::perspective}) {
        RenderOptions o = ideal(96);
        o.view.projection = projection;
        for (const double at : {2.5, 3.0, 3.4567}) {
            SphereScene scene;
            scene.centre = {{at, 2.8, 0.7}};
            Snapshot s = snapshot_of(scene, 6);
            s.velocity = {{2.0, -1.0, 0.5}};  // sqrt(ga): 0.1 a within the exposure
            RunPlan plan;
            Renderer renderer(o, md_info(), s.box, 1, 1, plan);
            const RenderedFrame rendered = renderer.render(s, 0);
            EXPECT_GT(rendered.sub_frames, 2);
            ASSERT_EQ(rendered.truth.size(), 1U);
            const Vec2 seen = centroid(rendered.frame.image);
            // Blur is cut at 4 σ and counts are rounded.
            EXPECT_NEAR(seen.x, rendered.truth.position[0].x, 2e-3);
            EXPECT_NEAR(seen.y, rendered.truth.position[0].y, 2e-3);
        }
    }
}

TEST(Renderer, ChordsAreUsedWhereThereAreNoVelocities) {
    SphereScene scene;
    scene.centre = {{3, 3, 0.7}};
    Snapshot now = snapshot_of(scene, 6);
    Snapshot next = now;
    next.position[0].x += 1;
    next.time = 0.5;
    RunPlan plan;
    Renderer renderer(ideal(96), md_info(), now.box, 1, 1, plan);
    EXPECT_EQ(renderer.render(now, 0).sub_frames, 1);
    const std::vector<Snapshot> both{now, next};
    const RenderedFrame moving = renderer.render({both, 0}, 0);
    EXPECT_GT(moving.sub_frames, 1);
    EXPECT_NEAR(moving.truth.velocity[0].x, 16 * 2 / std::sqrt(1e-3 / 9.80665), 1e-6);
}

// A sphere that turns round in the middle of the exposure: the truth is the mean of its path, and
// the image shows it there.
TEST(Renderer, FollowsACollisionWithinTheExposure) {
    SphereScene scene;
    scene.centre = {{3, 3, 0.7}};
    const double unit = std::sqrt(1e-3 / 9.80665);
    const double half = 0.5e-3 / 2 / unit;  // of the exposure
    Snapshot before = snapshot_of(scene, 6);
    before.velocity = {{2, 0, 0}};
    before.time = -2 * half;
    Snapshot now = snapshot_of(scene, 6);
    now.velocity = {{-2, 0, 0}};  // it has just come back from where it turned, at −half/2
    before.position[0].x = 3 + 2 * (half / 2) - 2 * (1.5 * half);
    Snapshot after = now;
    after.time = 2 * half;
    after.position[0].x -= 2 * (2 * half);
    for (Snapshot* s : {&before, &after}) {
        const double t = s->time;
        s->z[0] = 0.7 - 0.5 * t * t;
        s->velocity[0].z = -t;
    }
    const std::vector<Snapshot> all{before, now, after};
    RunPlan plan;
    RenderOptions o = ideal(96);
    o.exposure.sub_frames = 64;
    Renderer renderer(o, md_info(), now.box, 1, 1, plan);
    const RenderedFrame rendered = renderer.render({all, 1}, 0);
    EXPECT_EQ(renderer.flights().turned, 1);
    EXPECT_EQ(renderer.flights().free, 1);
    const double turned = 3 + 2 * (half / 2);
    const double coming = turned - 2 * (half / 2) / 2;   // mean over a quarter of the time
    const double going = turned - 2 * (1.5 * half) / 2;  // over three quarters
    const double mean = 0.25 * coming + 0.75 * going;
    const View& view = renderer.view();
    const double expected = view.project({mean, 3, 0.7}).x;
    EXPECT_NEAR(rendered.truth.position[0].x, expected, 0.004);
    EXPECT_NEAR(centroid(rendered.frame.image).x, rendered.truth.position[0].x, 2e-3);
    EXPECT_EQ(renderer.truth({all, 1}, 0).position, rendered.truth.position);
    // Straight on from the snapshot it would have been farther out before.
    EXPECT_GT(renderer.truth({{&now, 1}, 0}, 0).position[0].x, expected + 0.02);
}

TEST(Renderer, PeriodicImagesFillTheFrameAndHaveTheirOwnIds) {
    SphereScene scene;
    scene.centre = {{0.1, 2, 0.7}, {2, 3.9, 0.7}, {2, 2, 1.2}};
    const Snapshot s = snapshot_of(scene, 4, Boundary::periodic);
    RenderOptions o = ideal(64);
    o.view.projection = Projection::telecentric;  // a pinhole sees slightly more of the low layer
    RunPlan plan;
    Renderer exact(o, md_info(), s.box, 1, 1, plan);
    const RenderedFrame one = exact.render(s, 0);
    EXPECT_EQ(one.truth.size(), 3U);
    // Half of grain 0 comes in from the right.
    EXPECT_LT(one.frame.image(63, 31), 0.5F * one.frame.image(48, 16));
    o.view.scale = 8;
    Renderer wide(o, md_info(), s.box, 1, 1, plan);
    const RenderedFrame four = wide.render(s, 0);
    EXPECT_EQ(four.truth.size(), 12U);
    EXPECT_EQ(std::set<std::int64_t>(four.truth.id.begin(), four.truth.id.end()).size(), 12U);
    o.view.scale = 1;
    EXPECT_THROW(Renderer(o, md_info(), s.box, 1, 1, plan), OptionError);
}

TEST(Renderer, LayersComeFromHeightsAndHeightsFromLayers) {
    Snapshot s = snapshot_of(crystal_scene(4, 1.0, 1.94), 4);
    RunPlan plan;
    Renderer renderer(ideal(64), md_info(), s.box, 1, 1, plan);
    const Snapshot from_heights = renderer.render(s, 0).truth;
    s.layer = from_heights.layer;
    s.z.clear();
    const Snapshot from_layers = renderer.render(s, 0).truth;
    ASSERT_EQ(from_heights.layer, from_layers.layer);
    for (std::size_t i = 0; i < from_heights.size(); ++i) {
        EXPECT_NEAR(from_heights.z[i], from_layers.z[i], 1e-9);
    }
    s.layer.clear();
    const Snapshot flat = renderer.render(s, 0).truth;
    EXPECT_TRUE(flat.z.empty());
    EXPECT_TRUE(flat.layer.empty());
    EXPECT_EQ(flat.size(), 16U);
}

TEST(Renderer, IsTheSameForAnyNumberOfThreads) {
    Snapshot s = snapshot_of(random_scene(300, 20, 1.94, 4), 20, Boundary::periodic);
    s.velocity.assign(s.size(), {0.5, 0.2, 0.1});
    RenderOptions o;
    o.view.width = 320;
    o.view.height = 240;
    o.exposure.jitter = 2;
    RunPlan plan;
    Renderer one(o, md_info(), s.box, 3, 1, plan);
    Renderer many(o, md_info(), s.box, 3, 8, plan);
    EXPECT_EQ(one.render(s, 5).frame.image, many.render(s, 5).frame.image);
    EXPECT_NE(one.render(s, 5).truth.position[0].x, one.render(s, 6).truth.position[0].x);
}

TEST(Renderer, LosesTheShareOfFramesAskedForAndSaysWhich) {
    const Snapshot s = snapshot_of({}, 4);
    RenderOptions o;
    o.view.width = 32;
    o.view.height = 32;
    o.exposure.drop_rate = 0.3;
    RunPlan plan;
    Renderer renderer(o, md_info(), s.box, 3, 1, plan);
    int lost = 0;
    for (int i = 0; i < 1000; ++i) {
        if (!renderer.loses(i)) continue;
        ++lost;
        EXPECT_EQ(renderer.render(s, i).frame.status, FrameStatus::missing);
    }
    EXPECT_NEAR(lost, 300, 75);  // five standard deviations
}

// Stress: what a camera or a simulation may come up with.
TEST(Renderer, RendersFramesOfNoneOneAndFortyThousandSpheres) {
    RunPlan plan;
    for (const int count : {0, 1, 40000}) {
        RenderOptions o;
        o.view.width = 640;
        o.view.height = 640;
        o.view.projection = Projection::telecentric;
        o.light.level = 0.03;  // a contrast of 3 % of full scale
        const Snapshot s = snapshot_of(random_scene(count, 200, 1.94, 2), 200, Boundary::periodic);
        Renderer renderer(o, md_info(), s.box, 3, 2, plan);
        const RenderedFrame rendered = renderer.render(s, 0);
        EXPECT_EQ(rendered.truth.size(), static_cast<std::size_t>(count));
        for (const float v : rendered.frame.image.pixels()) {
            ASSERT_GE(v, 0);
            ASSERT_LE(v, 255);
            ASSERT_EQ(v, std::round(v));
        }
    }
}

}  // namespace
}  // namespace grainfield::simulate
