#include "simulate/render/sensor/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "simulate/render/optics/silhouette.h"
#include "simulate/render/sensor/gaussian_blur.h"
#include "tests/simulate/render/render_scenes.h"

namespace grainfield::simulate {
namespace {

RenderOptions even_light() {
    RenderOptions o;
    o.view.width = 300;
    o.view.height = 200;
    o.view.scale = 16;
    o.light.falloff = 0;
    o.light.vignetting = false;
    o.light.dust = 0;
    o.sensor.prnu = 0;
    o.sensor.defects = 0;
    return o;
}

View view_of(const RenderOptions& o) {
    return {o.view, square_box(20), 1.94};
}

struct Moments {
    double mean = 0;
    double variance = 0;
    double skewness = 0;
};

Moments moments(const Image& image) {
    Moments m;
    const auto n = static_cast<double>(image.size());
    for (const float v : image.pixels()) m.mean += static_cast<double>(v) / n;
    for (const float v : image.pixels()) {
        const double d = static_cast<double>(v) - m.mean;
        m.variance += d * d / (n - 1);
        m.skewness += d * d * d / n;
    }
    m.skewness /= std::pow(m.variance, 1.5);
    return m;
}

// Relative standard error of a variance of n Gaussian numbers is sqrt(2/n): 0.0058 for 60,000
// pixels; bars of 5 standard errors are missed once in 2e6.
TEST(Camera, VarianceFollowsThePhotonTransferLaw) {
    for (const int bits : {8, 10, 12, 16}) {
        RenderOptions o = even_light();
        o.sensor.bits = bits;
        const Camera camera(o, view_of(o), 5, 1);
        for (const double exposure : {0.02, 0.1, 0.4, 0.9}) {
            const Image even(o.view.width, o.view.height, static_cast<float>(exposure));
            const Moments m = moments(camera.develop(even, 3).image);
            const double variance = camera.variance_counts(exposure);
            const auto n = static_cast<double>(even.size());
            EXPECT_NEAR(m.mean, camera.mean_counts(exposure), 5 * std::sqrt(variance / n) + 1e-3);
            EXPECT_NEAR(m.variance / variance, 1, 5 * std::sqrt(2 / n)) << bits << ' ' << exposure;
        }
    }
}

TEST(Camera, FewElectronsArePoissonDistributed) {
    RenderOptions o = even_light();
    o.sensor.bits = 16;
    o.sensor.full_well = 1000;
    o.sensor.read_noise = 0;
    o.sensor.gain = 10;
    o.sensor.offset = 0;
    o.light.level = 1;
    const Camera camera(o, view_of(o), 5, 1);
    for (const double electrons : {0.0, 0.5, 5.0, 15.0, 25.0, 200.0}) {
        const Image even(o.view.width, o.view.height, static_cast<float>(electrons / 1000));
        const Moments m = moments(camera.develop(even, 1).image);
        const auto n = static_cast<double>(even.size());
        EXPECT_NEAR(m.mean / 10, electrons, 5 * std::sqrt(electrons / n) + 1e-3);
        if (electrons == 0) continue;
        // Var of a Poisson sample variance: (2 + 1/μ)/n, relative.
        EXPECT_NEAR(m.variance / 100 / electrons, 1,
                    5 * std::sqrt((2 + 1 / electrons) / n) + 0.002);
        EXPECT_NEAR(m.skewness, 1 / std::sqrt(electrons), 0.05 * (1 + 1 / electrons));
    }
}

TEST(Camera, BlurOfAStraightEdgeIsTheErrorFunction) {
    for (const double sigma : {0.02, 0.05, 0.08, 0.2}) {  // [a]: 0.3 … 3.2 px
        RenderOptions o = even_light();
        o.camera = CameraKind::ideal;
        o.light.blur = sigma;
        const Camera camera(o, view_of(o), 1, 1);
        const View fine = camera.radiance_view(view_of(o));
        Image edge(fine.width(), fine.height());
        const int n = camera.supersampling();
        // On a border of pixels, and not [px].
        for (const double at : {150.5, 150.5 + 0.37, 150.5 + 0.5}) {
            for (int y = 0; y < edge.height(); ++y) {
                for (int x = 0; x < edge.width(); ++x) {
                    const double border = (at + 0.5 + camera.margin()) * n;
                    edge(x, y) = static_cast<float>(std::clamp(x + 1 - border, 0.0, 1.0));
                }
            }
            const Image seen = camera.exposure(edge);
            ASSERT_EQ(seen.width(), o.view.width);
            ASSERT_EQ(seen.height(), o.view.height);
            const double s = sigma * 16;
            // ∫ over a pixel of Φ((x − at)/s).
            const auto primitive = [&](double x) {
                const double u = (x - at) / s;
                return s * (u * 0.5 * std::erfc(-u / std::sqrt(2.0)) +
                            std::exp(-u * u / 2) / std::sqrt(2 * std::numbers::pi));
            };
            for (int x = 140; x < 162; ++x) {
                const double expected = primitive(x + 0.5) - primitive(x - 0.5);
                EXPECT_NEAR(double{seen(x, 100)}, expected, 3e-3) << s << ' ' << x;
            }
        }
    }
}

TEST(Camera, MapIsOneAtItsBrightestAndFallsAsAsked) {
    RenderOptions o = even_light();
    o.light.falloff = 0.3;
    o.light.gradient = 0.5;
    const Camera camera(o, view_of(o), 1, 1);
    const Image& map = camera.illumination();
    EXPECT_FLOAT_EQ(*std::max_element(map.pixels().begin(), map.pixels().end()), 1);
    EXPECT_LT(map(299, 100), 0.6F * map(0, 100));
    EXPECT_NEAR(map(10, 20), map(10, 179), 1e-6);
}

TEST(Camera, SaturatesAtFullWellAndClipsAtFullScale) {
    RenderOptions o = even_light();
    o.light.level = 3;
    const Camera camera(o, view_of(o), 1, 1);
    const Frame frame = camera.develop(Image(300, 200, 1.0F), 0);
    for (const float value : frame.image.pixels()) ASSERT_EQ(value, 255);
    RenderOptions low = even_light();
    low.sensor.gain = 0.01;  // full well is 100 counts above the offset
    low.light.level = 3;
    const Camera dim(low, view_of(low), 1, 1);
    const Frame dimmed = dim.develop(Image(300, 200, 1.0F), 0);
    for (const float value : dimmed.image.pixels()) ASSERT_EQ(value, 104);
}

TEST(Camera, IdealOneHasNoNoise) {
    RenderOptions o = even_light();
    o.camera = CameraKind::ideal;
    o.light.dust = 20;
    o.sensor.prnu = 0.1;
    o.sensor.defects = 0.01;
    const Camera camera(o, view_of(o), 1, 1);
    const Frame frame = camera.develop(Image(300, 200, 0.5F), 0);
    const auto expected = static_cast<float>(std::round(camera.mean_counts(0.5)));
    for (const float value : frame.image.pixels()) ASSERT_EQ(value, expected);
}

TEST(Camera, FixedPatternsStayAndNoiseDoesNot) {
    RenderOptions o = even_light();
    o.sensor.prnu = 0.1;
    o.sensor.bits = 12;
    const Camera camera(o, view_of(o), 1, 1);
    const Image even(300, 200, 0.5F);
    const Image a = camera.develop(even, 0).image;
    const Image b = camera.develop(even, 1).image;
    EXPECT_NE(a, b);
    Image difference(300, 200);
    for (std::size_t i = 0; i < a.size(); ++i)
        difference.pixels()[i] = a.pixels()[i] - b.pixels()[i];
    EXPECT_NEAR(moments(difference).variance / (2 * camera.variance_counts(0.5)), 1, 0.05);
    EXPECT_NEAR(std::sqrt(moments(a).variance) / camera.mean_counts(0.5), 0.1, 0.005);
}

TEST(Camera, DefectsAreAsManyAsAsked) {
    RenderOptions o = even_light();
    o.sensor.defects = 0.001;
    const Camera camera(o, view_of(o), 1, 1);
    const Frame frame = camera.develop(Image(300, 200, 0.5F), 0);
    const auto& p = frame.image.pixels();
    EXPECT_NEAR(static_cast<double>(std::count(p.begin(), p.end(), 255.0F)), 60, 2);
    EXPECT_NEAR(static_cast<double>(std::count(p.begin(), p.end(), 4.0F)), 60, 2);
}

TEST(Camera, GivesTheSameBytesForAnyNumberOfThreadsAndOthersForAnotherSeed) {
    const RenderOptions o = [] {
        RenderOptions options = even_light();
        options.light.stray = 0;
        options.light.dust = 5;
        options.sensor.prnu = 0.01;
        return options;
    }();
    const View view = view_of(o);
    SilhouetteOptics optics({}, 1);
    const Camera one(o, view, 11, 1);
    const Image radiance = optics.radiance(random_scene(200, 20, 1.94, 3), one.radiance_view(view));
    const Image reference = one.photograph(radiance, 4).image;
    for (const int threads : {2, 8}) {
        EXPECT_EQ(reference, Camera(o, view, 11, threads).photograph(radiance, 4).image);
    }
    EXPECT_NE(reference, Camera(o, view, 12, 1).photograph(radiance, 4).image);
}

TEST(Camera, RefusesSensorsThatDoNotExist) {
    RenderOptions o = even_light();
    o.sensor.bits = 9;
    EXPECT_THROW(Camera(o, view_of(o), 1, 1), OptionError);
    o.sensor.bits = 8;
    o.sensor.offset = 255;
    EXPECT_THROW(Camera(o, view_of(o), 1, 1), OptionError);
}

}  // namespace
}  // namespace grainfield::simulate
