#include "simulate/render/optics/raytrace.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "simulate/render/optics/fresnel.h"
#include "simulate/render/sensor/camera.h"
#include "tests/simulate/render/render_scenes.h"

namespace grainfield::simulate {
namespace {

std::unique_ptr<Optics> make_optics(const RenderOptions& options) {
    return options.optics.chosen().make(bright_field_noise(options), 2);
}

double tolerance_of(const RenderOptions& options) {
    return sampling_tolerance(options.optics.of<Raytrace>(), bright_field_noise(options));
}

double rms_difference(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double d = static_cast<double>(a.pixels()[i] - b.pixels()[i]);
        sum += d * d;
    }
    return std::sqrt(sum / static_cast<double>(a.size()));
}

TEST(Fresnel, HasTheKnownLimits) {
    const double n = 2.87;
    const double k = 3.36;
    const double normal = ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k);
    EXPECT_NEAR(metal_reflectance(1, n, k), normal, 1e-12);
    EXPECT_NEAR(metal_reflectance(0, n, k), 1, 1e-12);
    // A metal that does not absorb is glass: r = ((n − 1)/(n + 1))², both faces 2 r/(1 + r).
    const double r = std::pow(0.52 / 2.52, 2);
    EXPECT_NEAR(metal_reflectance(1, 1.52, 0), r, 1e-12);
    EXPECT_NEAR(plate_reflectance(1), 2 * r / (1 + r), 1e-12);
    EXPECT_NEAR(plate_reflectance(0), 1, 1e-9);
    EXPECT_DOUBLE_EQ(schlick_reflectance(1, 0.65), 0.65);
    EXPECT_DOUBLE_EQ(schlick_reflectance(0, 0.65), 1);
    EXPECT_DOUBLE_EQ(schlick_reflectance(0.5, 0.68), 0.69);
}

// One sphere, no glass, telecentric: the ray at impact ρ leaves at 2θ, sin θ = ρ/R, downwards if
// ρ > R/√2, and sees the panel if it falls within its half size.
TEST(Raytrace, OneSphereHasTheRadianceOfTheClosedForm) {
    SphereScene scene;
    scene.high_plate = 1.94;
    scene.centre = {{2, 2, 0.5}};
    RaytraceOptions options;
    options.glass_thickness = 0;
    options.panel_distance = 30;
    options.panel_half_size = 60;
    options.tolerance = 0.005;
    options.most_samples = 64;
    RaytraceOptics optics(options, 1);
    const View view = square_view(801, 4, Projection::telecentric);
    const Image image = optics.radiance(scene, view);
    for (const double part : {0.0, 0.3, 0.6, 0.69, 0.75, 0.8, 0.9, 0.95, 0.98}) {
        const int x = 400 + static_cast<int>(std::lround(part * 0.5 * view.scale()));
        const double theta = std::asin(std::min(1.0, (x - 400) / (0.5 * view.scale())));
        const double down = -std::cos(2 * theta);
        double expected = 0;
        if (down > 0) {
            const double height = 0.5 + 0.5 * std::cos(theta) + options.panel_distance;
            const double reach = height * std::sin(2 * theta) / down + 0.5 * std::sin(theta);
            if (reach < options.panel_half_size) expected = metal_reflectance(std::cos(theta));
        }
        EXPECT_NEAR(static_cast<double>(image(x, 400)), expected, 0.012) << part;
    }
    EXPECT_EQ(image(10, 10), 1);
    EXPECT_GT(optics.cost().settled, 0.9 * optics.cost().pixels);
}

// The same with a mirror of known reflectance instead of iron, Schlick's formula.
TEST(Raytrace, ASphereOfGivenReflectivityHasTheRadianceOfSchlicksFormula) {
    SphereScene scene;
    scene.high_plate = 1.94;
    scene.centre = {{2, 2, 0.5}};
    RaytraceOptions options;
    options.glass_thickness = 0;
    options.panel_distance = 30;
    options.panel_half_size = 1e4;
    options.tolerance = 0.005;
    options.most_samples = 64;
    options.reflectivity = 0.8;
    RaytraceOptics optics(options, 1);
    const View view = square_view(801, 4, Projection::telecentric);
    const Image image = optics.radiance(scene, view);
    for (const double part : {0.3, 0.6, 0.75, 0.8, 0.9, 0.95}) {
        const int x = 400 + static_cast<int>(std::lround(part * 0.5 * view.scale()));
        const double rho = (x - 400) / (0.5 * view.scale());
        const double cosine = std::sqrt(1 - rho * rho);
        const double expected = cosine * cosine < 0.5 ? 0.8 + 0.2 * std::pow(1 - cosine, 5) : 0;
        EXPECT_NEAR(static_cast<double>(image(x, 400)), expected, 0.004) << part;
    }
}

// Black spheres, so that only the geometry of the rays counts: each pixel is the share of 1,200
// rays that pass, 100 through each point of the lens. Standard error of a half-covered pixel 0.015
// if the rays were independent; those of the R2 sequence do better.
TEST(Raytrace, RaysThroughTheLensMeetWhatSilhouettesCover) {
    const SphereScene scene = crystal_scene(4, 0.95, 1.94);
    for (const Projection projection : {Projection::telecentric, Projection::perspective}) {
        ViewOptions options;
        options.width = options.height = 60;
        options.projection = projection;
        options.distance = 100;
        options.aperture = 0.25;
        const View view(options, square_box(4), 1.94);
        RaytraceOptions black;
        black.glass_thickness = 0;
        black.panel_half_size = 1e4;
        black.bounces = 0;
        black.tolerance = 0;
        black.most_samples = 1200;
        RaytraceOptics rays(black, 2);
        SilhouetteOptics discs({}, 2);
        const Image traced = rays.radiance(scene, view);
        const Image covered = discs.radiance(scene, view);
        double worst = 0;
        for (std::size_t i = 0; i < traced.size(); ++i) {
            worst = std::max(
                worst, static_cast<double>(std::abs(traced.pixels()[i] - covered.pixels()[i])));
        }
        // A disc stands for the outline that is wider by |u|²/2 along the slope of the lens: 0.03
        // of its radius of 7.5 px, 0.23 px at most.
        EXPECT_LT(worst, 0.25);
        EXPECT_LT(rms_difference(traced, covered), 0.03);
        // Without the lens the two differ where edges are out of focus.
        options.aperture = 0;
        EXPECT_GT(rms_difference(traced, discs.radiance(scene, {options, square_box(4), 1.94})),
                  0.06);
    }
}

// Darkness of an isolated sphere of a = 10.09 px, measured on a real frame at random sub-pixel
// positions. Panel 20 a below (half of it glass), 150 a wide, Lambertian; point spread of σ = 0.08
// a; not saturated.
TEST(Raytrace, AnIsolatedSphereHasTheMeasuredProfile) {
    RenderOptions options;
    options.camera = CameraKind::ideal;
    options.view.width = 41;
    options.view.height = 41;
    options.view.scale = 10.09;
    options.light.blur = 0.08;
    options.optics.of<Raytrace>().panel_distance = 20;
    options.optics.of<Raytrace>().panel_half_size = 75;
    const View view(options.view, square_box(4), 1.94);
    const Camera camera(options, view, 1, 1);
    RaytraceOptics optics(options.optics.of<Raytrace>(), 1);
    std::vector<std::pair<Image, Vec2>> seen;
    for (int i = 0; i < 9; ++i) {
        SphereScene scene;
        scene.high_plate = 1.94;
        scene.centre = {{2 + (i % 3) / 30.27 + 0.003, 2 + (i / 3) / 30.27 + 0.003, 0.5}};
        seen.emplace_back(camera.exposure(optics.radiance(scene, camera.radiance_view(view))),
                          view.project(scene.centre[0]));
    }
    const double core = static_cast<double>(seen[0].first(20, 20));
    constexpr std::array<std::pair<double, double>, 6> measured{
        {{2.25, 0.946}, {3.25, 0.839}, {4.25, 0.553}, {4.75, 0.363}, {5.25, 0.199}, {6.25, 0.026}}};
    for (const auto& [r, darkness] : measured) {
        double sum = 0;
        int count = 0;
        for (const auto& [image, centre] : seen) {
            for (int y = 0; y < image.height(); ++y) {
                for (int x = 0; x < image.width(); ++x) {
                    if (std::abs(std::hypot(x - centre.x, y - centre.y) - r) > 0.25) continue;
                    sum += (1 - static_cast<double>(image(x, y))) / (1 - core);
                    ++count;
                }
            }
        }
        ASSERT_GT(count, 0);
        EXPECT_NEAR(sum / count, darkness, 0.05) << r;
    }
}

SphereScene moved(SphereScene scene, Vec3 by) {
    for (Vec3& p : scene.centre) p = p + by;
    return scene;
}

// Of the image that the sensor sees, after the blur: 0.08 a.
TEST(Raytrace, SamplingErrorIsBelowOnePerCentOfContrast) {
    const SphereScene scene = crystal_scene(8, 0.81, 1.94);
    RenderOptions options;
    options.camera = CameraKind::ideal;
    options.view.width = 104;
    options.view.height = 104;
    options.view.scale = 16;
    const View view(options.view, square_box(6.48), 1.94);
    const Camera camera(options, view, 1, 1);
    RaytraceOptics optics({}, 1);
    RaytraceOptions fine;
    fine.tolerance = 0;
    fine.most_samples = 128;
    RaytraceOptics reference(fine, 1);
    const Image a = camera.exposure(optics.radiance(scene, camera.radiance_view(view)));
    const Image b = camera.exposure(reference.radiance(scene, camera.radiance_view(view)));
    const double error = rms_difference(a, b);
    RecordProperty("rms_error", std::to_string(error));
    EXPECT_LT(error, 0.01);
    EXPECT_LT(optics.cost().rays, 0.3 * reference.cost().rays);
}

// With noise, dust and all: what is saved must not be seen in the frame, whether it is bright (a
// liquid's spacing) or dark (a crystal's).
void expect_sampling_below_noise(double spacing) {
    const SphereScene start = crystal_scene(8, spacing, 1.94);
    const std::vector<SphereScene> instants{start, moved(start, {0.03, 0, 0.01}),
                                            moved(start, {0.06, 0, 0.02})};
    RenderOptions options;
    options.view.width = 104;
    options.view.height = 104;
    options.view.scale = 16;
    options.sensor.bits = 12;
    options.optics.select("raytrace");
    const View view(options.view, square_box(8 * spacing), 1.94);
    const Camera camera(options, view, 1, 1);
    RaytraceOptions all_alike;
    all_alike.tolerance = 0;
    all_alike.most_samples = 128;
    const auto adaptive = make_optics(options);
    RaytraceOptics uniform(all_alike, 2);
    const View fine = camera.radiance_view(view);
    const Image a = camera.exposure(adaptive->radiance(instants, fine));
    const Image b = camera.exposure(uniform.radiance(instants, fine));
    const double unit = camera.mean_counts(1) - camera.mean_counts(0);
    double noise = 0;
    double shift = 0;
    for (std::size_t i = 0; i < b.size(); ++i) {
        noise += camera.variance_counts(static_cast<double>(b.pixels()[i]));
        shift += static_cast<double>(a.pixels()[i] - b.pixels()[i]);
    }
    noise = std::sqrt(noise / static_cast<double>(b.size())) / unit;
    shift /= static_cast<double>(b.size());
    ::testing::Test::RecordProperty("rms_difference", std::to_string(rms_difference(a, b)));
    ::testing::Test::RecordProperty("noise", std::to_string(noise));
    ::testing::Test::RecordProperty("mean_difference", std::to_string(shift));
    EXPECT_LT(rms_difference(a, b), noise) << spacing;
    EXPECT_LT(std::abs(shift), 0.002) << "of the bright field";
}

TEST(Raytrace, AdaptiveSamplingDiffersFromUniformByLessThanTheNoiseOfTheCamera) {
    expect_sampling_below_noise(0.81);
    expect_sampling_below_noise(0.924);
}

TEST(Raytrace, ACameraOfLessNoiseGetsMoreSamples) {
    RenderOptions usual;
    usual.optics.select("raytrace");
    RenderOptions quiet = usual;
    quiet.sensor.full_well = 4e4;
    EXPECT_NEAR(tolerance_of(quiet) / tolerance_of(usual), 0.25, 0.01);
    const SphereScene scene = crystal_scene(6, 0.81, 1.94);
    const View view = square_view(64, 4.86, Projection::perspective);
    const auto few = make_optics(usual);
    const auto many = make_optics(quiet);
    static_cast<void>(few->radiance(scene, view));
    static_cast<void>(many->radiance(scene, view));
    EXPECT_GT(many->cost().samples, 1.5 * few->cost().samples);
    quiet.optics.of<Raytrace>().tolerance = 0.1;
    EXPECT_EQ(tolerance_of(quiet), 0.1);
}

// The plates of the experiment swing by 0.08 a; those of the renderer stand still. Refraction is
// the same wherever a plate is; what moves is what the plates mirror.
TEST(Raytrace, PlatesThatSwingChangeLessThanTheNoiseOfTheCamera) {
    SphereScene scene = crystal_scene(8, 0.81, 1.94);
    for (Vec3& p : scene.centre) p.z = p.z < 1 ? 0.59 : 1.35;
    SphereScene up = scene;
    up.low_plate += 0.08;
    up.high_plate += 0.08;
    RenderOptions options;
    options.view.width = 104;
    options.view.height = 104;
    options.view.scale = 16;
    const View view(options.view, square_box(6.48), 1.94);
    const Camera camera(options, view, 1, 1);
    RaytraceOptions still;
    still.tolerance = 0;
    still.most_samples = 32;
    RaytraceOptions swung = still;
    swung.panel_distance += 0.08;  // the panel does not swing
    RaytraceOptics low(still, 2);
    RaytraceOptics high(swung, 2);
    const View fine = camera.radiance_view(view);
    const Image a = camera.exposure(low.radiance(scene, fine));
    const Image b = camera.exposure(high.radiance(up, fine));
    const double unit = camera.mean_counts(1) - camera.mean_counts(0);
    double noise = 0;
    for (const float v : a.pixels()) noise += camera.variance_counts(static_cast<double>(v));
    noise = std::sqrt(noise / static_cast<double>(a.size())) / unit;
    RecordProperty("rms_difference", std::to_string(rms_difference(a, b)));
    RecordProperty("noise", std::to_string(noise));
    EXPECT_GT(rms_difference(a, b), 0);
    EXPECT_LT(rms_difference(a, b), noise);
}

TEST(Raytrace, WithoutNeighboursASphereLooksAsIfItWereAlone) {
    SphereScene pair;
    pair.high_plate = 1.94;
    pair.centre = {{2, 2, 0.5}, {3.1, 2, 0.5}};
    SphereScene single = pair;
    single.centre.pop_back();
    RaytraceOptions options;
    options.tolerance = 0;
    options.most_samples = 8;
    RaytraceOptions blind = options;
    blind.neighbours = false;
    const View view = square_view(200, 4, Projection::telecentric);
    RaytraceOptics all(options, 1);
    RaytraceOptics none(blind, 1);
    const Image mirrored = all.radiance(pair, view);
    const Image alone = all.radiance(single, view);
    const Image ignored = none.radiance(pair, view);
    const Image blind_alone = none.radiance(single, view);
    double worst = 0;
    double ghost = 0;
    double seen = 0;
    for (int y = 50; y < 150; ++y) {
        for (int x = 50; x < 127; ++x) {  // the first sphere ends at 125
            worst = std::max(worst, std::abs(double{ignored(x, y)} - double{blind_alone(x, y)}));
            // The sphere in the plates is left out too.
            ghost = std::max(ghost, std::abs(double{ignored(x, y)} - double{alone(x, y)}));
            seen = std::max(seen, std::abs(static_cast<double>(mirrored(x, y) - alone(x, y))));
        }
    }
    EXPECT_EQ(worst, 0);
    EXPECT_LT(ghost, 0.06);
    EXPECT_GT(seen, 0.1);
}

TEST(Raytrace, SaysHowManyRaysUniformSamplingWouldTake) {
    // So small a tolerance gives almost every pixel that spheres touch all of four samples.
    const SphereScene scene = crystal_scene(8, 0.95, 1.94);
    const View view = square_view(256, 7.6, Projection::perspective);
    RaytraceOptions four;
    four.most_samples = 4;
    four.tolerance = 0.005;
    RaytraceOptions all_alike = four;
    all_alike.tolerance = 0;
    RaytraceOptics adaptive(four, 2);
    RaytraceOptics uniform(all_alike, 2);
    static_cast<void>(adaptive.radiance(scene, view));
    static_cast<void>(uniform.radiance(scene, view));
    EXPECT_NEAR(adaptive.cost().uniform_rays / uniform.cost().rays, 1, 0.15);
    EXPECT_DOUBLE_EQ(uniform.cost().uniform_rays, uniform.cost().rays);
    EXPECT_LT(adaptive.cost().rays, 0.98 * uniform.cost().rays);
    RaytraceOptics usual({}, 2);
    static_cast<void>(usual.radiance(scene, view));
    EXPECT_LT(usual.cost().rays, 0.9 * usual.cost().uniform_rays);
}

// Every ray sees one instant: the image is the mean over them, at the cost of one.
TEST(Raytrace, MotionBlurIsTheMeanOverTheInstants) {
    const SphereScene start = crystal_scene(6, 0.9, 1.94);
    const std::vector<SphereScene> instants{start, moved(start, {0.1, 0.02, 0}),
                                            moved(start, {0.2, 0.04, 0})};
    const View view = square_view(90, 5.4, Projection::perspective);
    RaytraceOptions dense;
    dense.tolerance = 0;
    dense.most_samples = 300;
    RaytraceOptics together(dense, 2);
    const Image blurred = together.radiance(instants, view);
    dense.most_samples = 100;
    RaytraceOptics apart(dense, 2);
    Image mean(view.width(), view.height());
    for (const SphereScene& scene : instants) {
        const Image image = apart.radiance(scene, view);
        for (std::size_t i = 0; i < mean.size(); ++i) mean.pixels()[i] += image.pixels()[i] / 3;
    }
    EXPECT_LT(rms_difference(blurred, mean), 0.01);
    EXPECT_GT(rms_difference(blurred, apart.radiance(start, view)), 0.05);
    EXPECT_NEAR(together.cost().rays / apart.cost().rays, 0.75, 0.05);  // three of apart's four
}

TEST(Raytrace, IsTheSameForAnyNumberOfThreadsAndForNoSpheres) {
    const SphereScene scene = crystal_scene(6, 0.9, 1.94);
    const View view = square_view(64, 6, Projection::perspective);
    RaytraceOptics one({}, 1);
    RaytraceOptics many({}, 8);
    EXPECT_EQ(one.radiance(scene, view), many.radiance(scene, view));
    const Image empty = one.radiance(SphereScene{}, view);
    for (const float value : empty.pixels()) ASSERT_NEAR(value, 1, 0.01);
}

}  // namespace
}  // namespace grainfield::simulate
