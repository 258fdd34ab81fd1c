#include "tracking/synthesis/mirror_image.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tracking/synthesis/rendered_layer.h"

namespace grainfield::tracking {
namespace {

constexpr double kScale = 12;  // [px/a]
constexpr int kSide = 84;      // [px]

const std::vector<Point3>& spheres() {
    static const std::vector<Point3> layer = testing::rendered_layer(9, kScale, 0, 5).spheres;
    return layer;
}

/// The sphere nearest to the middle of the frame.
std::int32_t middle_sphere() {
    const auto middle = static_cast<float>(0.5 * kSide / kScale);
    std::size_t nearest = 0;
    float least = 1e9F;
    for (std::size_t i = 0; i < spheres().size(); ++i) {
        const float d = std::hypot(spheres()[i].x - middle, spheres()[i].y - middle);
        if (d < least) {
            least = d;
            nearest = i;
        }
    }
    return static_cast<std::int32_t>(nearest);
}

Image rendering(const std::vector<Point3>& of, int threads = 2) {
    MirrorImage image(kSide, kSide, kScale, threads);
    image.render(MirrorScene(of, {}));
    return image.image();
}

/// RMS of derivative − difference of two full renderings, over the RMS of the latter, of all
/// spheres 1.2 a or more within the frame.
double mismatch(Point3 step) {
    MirrorImage image(kSide, kSide, kScale, 2);
    const MirrorScene scene(spheres(), {});
    image.render(scene);
    const float length = std::sqrt(step.x * step.x + step.y * step.y + step.z * step.z);
    const auto farthest = static_cast<float>(kSide / kScale - 1.2);
    double wrong = 0;
    double all = 0;
    int counted = 0;
    for (std::size_t i = 0; i < spheres().size(); ++i) {
        std::vector<Point3> moved = spheres();
        Point3& p = moved[i];
        if (std::min(p.x, p.y) < 1.2F || std::max(p.x, p.y) > farthest) continue;
        ++counted;
        p = {p.x + step.x, p.y + step.y, p.z + step.z};
        const ImagePatch patch = image.derivative(scene, static_cast<std::int32_t>(i), step);
        const Image there = rendering(moved);
        for (int y = 0; y < kSide; ++y) {
            for (int x = 0; x < kSide; ++x) {
                const auto difference =
                    static_cast<double>((there(x, y) - image.image()(x, y)) / length);
                const bool is_held = x >= patch.x && y >= patch.y && x < patch.x + patch.width &&
                                     y < patch.y + patch.height;
                const double said =
                    is_held ? static_cast<double>(patch.row(y - patch.y)[x - patch.x]) : 0;
                wrong += (said - difference) * (said - difference);
                all += difference * difference;
            }
        }
    }
    EXPECT_GT(counted, 15);
    return std::sqrt(wrong / all);
}

// What is mirrored farther away than 1.6 a is left out of a derivative: more of it where a sphere
// moves vertically.
TEST(MirrorImage, ADerivativeIsTheDifferenceOfTwoRenderingsToOneTwentiethAndInHeightToThreeTenths) {
    EXPECT_LT(mismatch({0.02F, 0, 0}), 0.05);
    EXPECT_LT(mismatch({0, 0.02F, 0}), 0.05);
    EXPECT_LT(mismatch({0, 0, 0.03F}), 0.3);
    EXPECT_LT(mismatch({0, 0, -0.03F}), 0.3);
}

TEST(MirrorImage, AChangeOverAllRaysIsTheDifferenceOfTwoRenderings) {
    MirrorImage image(kSide, kSide, kScale, 2);
    const MirrorScene scene(spheres(), {});
    image.render(scene);
    const std::int32_t sphere = middle_sphere();
    std::vector<Point3> moved = spheres();
    Point3& p = moved[static_cast<std::size_t>(sphere)];
    p = {p.x + 0.1F, p.y - 0.05F, p.z > 0.4F ? p.z - 0.3F : p.z + 0.3F};
    const Image there = rendering(moved);
    const ImagePatch patch = image.change(scene, sphere, p, 20);
    ASSERT_EQ(patch.width, kSide);
    ASSERT_EQ(patch.height, kSide);
    double wrong = 0;
    double all = 0;
    // Blurs differ at the border only: there a rendering repeats its last pixel.
    for (int y = 5; y < kSide - 5; ++y) {
        for (int x = 5; x < kSide - 5; ++x) {
            const double difference = static_cast<double>(there(x, y) - image.image()(x, y));
            const double said = static_cast<double>(patch.row(y)[x]);
            wrong += (said - difference) * (said - difference);
            all += difference * difference;
        }
    }
    EXPECT_GT(all, 0.1);
    EXPECT_LT(std::sqrt(wrong / all), 0.03);
}

TEST(MirrorImage, RenderingsUnderSeveralOpticsAreThoseMadeOneByOne) {
    std::vector<MirrorOptics> optics(3);
    optics[1] = {.reflectivity = 0.5, .blur = 0.1};
    optics[2] = {.ambient = 0.2, .grazing = 0.4};
    const MirrorImage image(kSide, kSide, kScale, 2);
    const std::vector<Image> together = image.renderings(MirrorScene(spheres(), {}), optics);
    ASSERT_EQ(together.size(), 3U);
    for (std::size_t n = 0; n < 3; ++n) {
        MirrorImage alone(kSide, kSide, kScale, 2);
        alone.render_only(MirrorScene(spheres(), optics[n]));
        EXPECT_EQ(together[n], alone.image()) << n;
    }
    EXPECT_NE(together[1], together[0]);
    EXPECT_NE(together[2], together[0]);
}

TEST(MirrorImage, RenderOnlyMakesTheSameImageToRounding) {
    MirrorImage image(kSide, kSide, kScale, 2);
    image.render_only(MirrorScene(spheres(), {}));
    const Image whole = rendering(spheres());
    for (std::size_t k = 0; k < whole.size(); ++k) {
        ASSERT_NEAR(image.image().pixels()[k], whole.pixels()[k], 1e-4) << k;
    }
}

TEST(MirrorImage, BitsDoNotDependOnTheNumberOfThreads) {
    EXPECT_EQ(rendering(spheres(), 1), rendering(spheres(), 3));
    const MirrorScene scene(spheres(), {});
    std::vector<std::vector<float>> values;
    for (const int threads : {1, 3}) {
        MirrorImage image(kSide, kSide, kScale, threads);
        image.render(scene);
        values.push_back(image.derivative(scene, middle_sphere(), {0, 0, 0.03F}).value);
    }
    EXPECT_EQ(values[0], values[1]);
}

TEST(MirrorImage, AnEmptyPanelIsOneAndASphereTakesItsShareOfTheLight) {
    const Image panel = rendering({});
    for (const float v : panel.pixels()) EXPECT_NEAR(v, 1, 1e-5);
    // The disc of the sphere and what its core and rim still send.
    const Image one = rendering({{3.5F, 3.5F, 0.2F}});
    double missing = 0;
    for (const float v : one.pixels()) missing += 1 - static_cast<double>(v);
    const MirrorOptics optics;
    double expected = 0;
    constexpr int kRings = 20000;
    for (int ring = 0; ring < kRings; ++ring) {
        const double rho = 0.5 * (ring + 0.5) / kRings;
        const double cosine = std::sqrt(1 - 4 * rho * rho);
        const double f = optics.reflectivity + (1 - optics.reflectivity) * std::pow(1 - cosine, 5);
        const bool meets_panel = 1 - 2 * cosine * cosine > optics.grazing;
        expected +=
            2 * 3.14159265 * rho * 0.5 / kRings * (1 - (meets_panel ? f : f * optics.ambient));
    }
    EXPECT_NEAR(missing / (kScale * kScale), expected, 0.01 * expected);
}

TEST(MirrorImage, RaysAPixelGrowFewerAsSpheresGrowLarger) {
    EXPECT_EQ(MirrorImage(8, 8, 5, 1).samples(), 4);
    EXPECT_EQ(MirrorImage(8, 8, 10, 1).samples(), 3);
    EXPECT_EQ(MirrorImage(8, 8, 16, 1).samples(), 2);
    EXPECT_EQ(MirrorImage(8, 8, 40, 1).samples(), 1);
}

TEST(MirrorImage, ABlurKeepsTheSumAndSpreadsByItsWidth) {
    Image point(41, 41);
    point(20, 20) = 1;
    const Image spread = gaussian_blurred(point, 2, 2);
    double sum = 0;
    double squares = 0;
    for (int y = 0; y < 41; ++y) {
        for (int x = 0; x < 41; ++x) {
            sum += static_cast<double>(spread(x, y));
            squares += static_cast<double>(spread(x, y)) * (x - 20) * (x - 20);
        }
    }
    EXPECT_NEAR(sum, 1, 1e-5);
    EXPECT_NEAR(squares, 4, 0.05);
}

}  // namespace
}  // namespace grainfield::tracking
