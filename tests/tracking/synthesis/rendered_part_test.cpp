#include "tracking/synthesis/rendered_part.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tracking/synthesis/rendered_layer.h"

namespace grainfield::tracking {
namespace {

constexpr double kScale = 12;  // a [px]
constexpr double kNoise = 0.01;

ImageModel model_of_discs() {
    ImageModel model;
    model.disc = {0.89 * kScale, 0.13 * kScale};
    model.background = BackgroundSurface(1.0);
    model.dark_level = 0;
    model.noise = kNoise;
    return model;
}

TEST(RenderedPart, ASmallFrameIsSampledInItsMiddle) {
    const Image counts(100, 59, 1.0F);
    const std::vector<FramePart> parts = parts_of(counts, model_of_discs(), 40);
    ASSERT_EQ(parts.size(), 1u);
    EXPECT_EQ(parts[0].x0, 30);
    EXPECT_EQ(parts[0].y0, 9);
    EXPECT_EQ(parts[0].brightness.width(), 40);
    EXPECT_EQ(parts[0].brightness.height(), 40);
}

TEST(RenderedPart, ALargeFrameIsSampledInTheMiddlesOfItsNinths) {
    Image counts(120, 60, 0.0F);
    counts(20, 10) = 1;
    const std::vector<FramePart> parts = parts_of(counts, model_of_discs(), 40);
    ASSERT_EQ(parts.size(), 9u);
    for (std::size_t k = 0; k < parts.size(); ++k) {
        EXPECT_EQ(parts[k].x0, 10 + 40 * static_cast<int>(k % 3));
        EXPECT_EQ(parts[k].y0, 20 * static_cast<int>(k / 3));
        EXPECT_EQ(parts[k].brightness.width(), 20);
    }
    EXPECT_FLOAT_EQ(parts[0].brightness(10, 10), 1);
    EXPECT_FLOAT_EQ(parts[0].brightness(9, 10), 0);
    EXPECT_EQ(parts[0].inside({12, 5}), 2);
    EXPECT_EQ(parts[0].inside({5, 5}), -5);
}

TEST(RenderedPart, OfTrueOpticsExplainsTheImageAndPlacesBesideItDoNot) {
    const auto layer = testing::rendered_layer(12, kScale, kNoise, 7);
    const ImageModel model = model_of_discs();
    const FramePart part = parts_of(layer.brightness, model, 20 * kScale).at(0);
    std::vector<Vec2> discs;
    for (const Point3& p : testing::displaced(layer, 0.02, 0, 3)) {
        discs.push_back({static_cast<double>(p.x) * kScale, static_cast<double>(p.y) * kScale});
    }
    const double side = layer.brightness.width();
    const RenderedPart fitted = fitted_part(
        part, model, discs,
        {.diameter = kScale, .height = layer.height, .frame_width = side, .frame_height = side}, 2);
    EXPECT_LT(fitted.rms, 2 * kNoise);
    std::vector<Vec2> same;
    std::vector<Vec2> beside;
    for (const Point3& p : fitted.spheres) {
        same.push_back({static_cast<double>(p.x) * kScale, static_cast<double>(p.y) * kScale});
        beside.push_back(same.back() + Vec2{0.03 * kScale, 0});
    }
    // The places are rounded to floats.
    EXPECT_NEAR(rms_at(same, fitted, part, kScale, 2), fitted.rms, 1e-3 * fitted.rms);
    EXPECT_GT(rms_at(beside, fitted, part, kScale, 2), 1.5 * fitted.rms);
}

TEST(RenderedPart, WithoutSpheresHasNone) {
    const Image counts(100, 100, 1.0F);
    const ImageModel model = model_of_discs();
    const FramePart part = parts_of(counts, model, 80).at(0);
    EXPECT_TRUE(
        fitted_part(part, model, {}, {.diameter = kScale, .height = 1.94}, 1).spheres.empty());
}

}  // namespace
}  // namespace grainfield::tracking
