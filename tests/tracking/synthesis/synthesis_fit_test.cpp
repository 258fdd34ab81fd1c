#include "tracking/synthesis/synthesis_fit.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tracking/synthesis/rendered_layer.h"

namespace grainfield::tracking {
namespace {

using testing::displaced;
using testing::rendered_layer;
using testing::RenderedLayer;

constexpr double kScale = 12;  // [px/a]

struct Rms {
    double x = 0, y = 0, z = 0;
};

/// Errors of the spheres 0.7 a or more within the frame, which come in the order of the truth [a].
Rms errors(const RenderedLayer& layer, const std::vector<Point3>& found) {
    Rms sum;
    double n = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const Point3& p = layer.spheres[i];
        if (!layer.is_inner(p, 0.7)) continue;
        sum.x += std::pow(static_cast<double>(found[i].x - p.x), 2);
        sum.y += std::pow(static_cast<double>(found[i].y - p.y), 2);
        sum.z += std::pow(static_cast<double>(found[i].z - p.z), 2);
        n += 1;
    }
    return {std::sqrt(sum.x / n), std::sqrt(sum.y / n), std::sqrt(sum.z / n)};
}

// The noise alone allows .001 a in the plane and .004 a in height (position_errors): the rounds
// end before that, as rays sample edges every 1/36 a and the misfit is rough at that scale.
TEST(SynthesisFit, EightRoundsBringAStartATenthAsFarFromTheTruthInThePlaneAndHalfInHeight) {
    const RenderedLayer layer = rendered_layer(12, kScale, 0.01, 11);
    SynthesisFit fit(layer.brightness, layer.ceiling, kScale, 2);
    fit.start(displaced(layer, 0.03, 0.1, 1), layer.optics);
    const double before = fit.rms();
    fit.refine({.height = layer.height, .most_rounds = 8, .settled = 1e-4});
    const Rms left = errors(layer, fit.spheres());
    EXPECT_LT(left.x, 0.0035);
    EXPECT_LT(left.y, 0.0035);
    EXPECT_LT(left.z, 0.055);
    EXPECT_GT(before, 0.03);
    EXPECT_LT(fit.rms(), 0.015);
}

TEST(SynthesisFit, SpheresThatAreReplacedLeaveTheInformationOfAFitThatBeginsWithTheNewOnes) {
    const RenderedLayer layer = rendered_layer(10, kScale, 0.01, 17);
    std::vector<Point3> others = layer.spheres;
    others.erase(others.begin() + 7);
    others.erase(others.begin() + 30);
    others.push_back({4, 4, 0.5F});
    SynthesisFit fit(layer.brightness, layer.ceiling, kScale, 2);
    fit.start(layer.spheres, layer.optics);
    fit.information();  // takes the derivatives
    fit.replace(others);
    SynthesisFit anew(layer.brightness, layer.ceiling, kScale, 2);
    anew.start(others, layer.optics);
    EXPECT_EQ(fit.residual(), anew.residual());
    const SynthesisFit::Information kept = fit.information();
    const SynthesisFit::Information fresh = anew.information();
    // What is mirrored over two other spheres may change too little to be looked at again.
    int same = 0;
    for (std::size_t i = 0; i < others.size(); ++i) {
        for (const std::size_t k : {0U, 4U, 8U}) {
            EXPECT_NEAR(kept.own[i][k], fresh.own[i][k], 0.05 * fresh.own[i][k]) << i;
        }
        same += kept.own[i] == fresh.own[i] ? 1 : 0;
    }
    EXPECT_GT(same, static_cast<int>(others.size()) / 2);
}

TEST(SynthesisFit, HeightsThatAreUnknownAreChosenFromTheImage) {
    const RenderedLayer layer = rendered_layer(12, kScale, 0.01, 16);
    std::vector<Point3> start = displaced(layer, 0.02, 0, 5);
    for (Point3& p : start) p.z = static_cast<float>(0.5 * (layer.height - 1));
    const SynthesisLimits limits{.height = layer.height, .most_rounds = 1};
    SynthesisFit fit(layer.brightness, layer.ceiling, kScale, 2, kScale);
    fit.start(start, layer.optics);
    const double before = errors(layer, fit.spheres()).z;
    for (int sweep = 0; sweep < 2; ++sweep) {
        EXPECT_GT(fit.choose_heights(limits, 0.7), 20);
    }
    fit.refine(limits);
    fit.choose_heights(limits, 0.7);
    EXPECT_GT(before, 0.25);
    EXPECT_LT(errors(layer, fit.spheres()).z, 0.4 * before);
}

TEST(SynthesisFit, SharpenedItComparesWithMoreRays) {
    const RenderedLayer layer = rendered_layer(8, kScale, 0, 17);
    SynthesisFit fit(layer.brightness, layer.ceiling, kScale, 2, kScale);
    fit.start(layer.spheres, layer.optics);
    const double rough = fit.rms();
    fit.sharpen(kRaysPerDiameter);
    EXPECT_LT(fit.rms(), 0.1 * rough);
    EXPECT_GT(fit.refine({.height = layer.height, .most_rounds = 1}), 0);
    EXPECT_LT(errors(layer, fit.spheres()).x, 0.001);
}

TEST(SynthesisFit, BitsDoNotDependOnTheNumberOfThreads) {
    const RenderedLayer layer = rendered_layer(7, kScale, 0.01, 12);
    std::vector<std::vector<Point3>> found;
    for (const int threads : {1, 3}) {
        SynthesisFit fit(layer.brightness, layer.ceiling, kScale, threads);
        fit.start(displaced(layer, 0.03, 0.1, 2), layer.optics);
        fit.refine({.height = layer.height, .most_rounds = 2});
        fit.fit_optics();
        found.push_back(fit.spheres());
        if (threads != 1) {
            EXPECT_NE(fit.optics().blur, layer.optics.blur);
        }
    }
    for (std::size_t i = 0; i < found[0].size(); ++i) {
        ASSERT_EQ(found[0][i].x, found[1][i].x);
        ASSERT_EQ(found[0][i].y, found[1][i].y);
        ASSERT_EQ(found[0][i].z, found[1][i].z);
    }
}

TEST(SynthesisFit, OpticsAndLightAreFoundWherePositionsAreKnown) {
    RenderedLayer layer = rendered_layer(9, kScale, 0.01, 13);
    for (float& v : layer.brightness.pixels()) v = 0.05F + 0.8F * v;
    SynthesisFit fit(layer.brightness, layer.ceiling, kScale, 2);
    MirrorOptics wrong = layer.optics;
    wrong.reflectivity = 0.5;
    wrong.blur = 0.09;
    wrong.grazing = 0.3;
    fit.start(layer.spheres, wrong);
    for (int round = 0; round < 3; ++round) fit.fit_optics();
    EXPECT_NEAR(fit.optics().reflectivity, layer.optics.reflectivity, 0.02);
    EXPECT_NEAR(fit.optics().blur, layer.optics.blur, 0.003);
    // Few rays leave so level: most meet another sphere.
    EXPECT_NEAR(fit.optics().grazing, layer.optics.grazing, 0.08);
    EXPECT_NEAR(fit.light().gain, 0.8, 0.01);
    EXPECT_NEAR(fit.rms(), 0.01, 0.0015);
}

TEST(SynthesisFit, FixedSpheresStayWhereTheyAre) {
    const RenderedLayer layer = rendered_layer(7, kScale, 0.01, 14);
    const std::vector<Point3> start = displaced(layer, 0.02, 0.05, 3);
    std::vector<char> is_fixed(start.size(), 1);
    is_fixed[0] = 0;
    is_fixed[5] = 0;
    SynthesisFit fit(layer.brightness, layer.ceiling, kScale, 2);
    fit.start(start, layer.optics, is_fixed, {});
    fit.refine({.height = layer.height, .most_rounds = 2});
    for (std::size_t i = 0; i < start.size(); ++i) {
        EXPECT_EQ(fit.spheres()[i].x == start[i].x && fit.spheres()[i].z == start[i].z,
                  is_fixed[i] != 0)
            << i;
    }
}

TEST(SynthesisFit, SpheresStayInTheCellAndOutOfOneAnother) {
    const RenderedLayer layer = rendered_layer(9, kScale, 0.01, 15);
    SynthesisFit fit(layer.brightness, layer.ceiling, kScale, 2);
    fit.start(displaced(layer, 0.03, 0.2, 4), layer.optics);
    const double before = fit.overlap();
    fit.refine({.height = layer.height, .most_rounds = 6});
    // The truth has no overlap; what is left is that of the errors.
    EXPECT_LT(fit.overlap(), 0.12 * before);
    for (const Point3& p : fit.spheres()) {
        EXPECT_GE(p.z, 0);
        EXPECT_LE(p.z, static_cast<float>(layer.height - 1));
    }
}

TEST(SynthesisFit, OverlapIsTheSumOfSquaredDepthsOverPairs) {
    const Image panel(60, 60, 1);
    const Image ceiling(60, 60, 10);
    SynthesisFit fit(panel, ceiling, kScale, 1);
    fit.start({{2, 2, 0}, {2.9F, 2, 0}, {2, 2.8F, 0}, {4.5F, 4, 0.3F}}, {});
    EXPECT_NEAR(fit.overlap(), 0.01 + 0.04, 1e-5);
}

}  // namespace
}  // namespace grainfield::tracking
