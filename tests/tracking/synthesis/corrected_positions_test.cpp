#include "tracking/synthesis/corrected_positions.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tracking/synthesis/bias_terms.h"

namespace grainfield::tracking {
namespace {

constexpr double kDiameter = 10;
constexpr int kSide = 80;

/// Remaining errors are .001 a, .002 a, … class by class.
BiasCorrection correction(double weight) {
    BiasCorrection correction;
    correction.weights.assign(BiasTerms::kCount, weight);
    correction.quality = {0.01, 0.02, 0.03};
    for (int c = 1; c <= kOverlapClasses * kQualityClasses; ++c) {
        correction.remaining.push_back(0.001 * c);
    }
    return correction;
}

Image noise(std::uint64_t stream) {
    Image image(kSide, kSide);
    RandomStream random(9, "image", stream);
    for (float& v : image.pixels()) v = static_cast<float>(0.1 * random.normal());
    return image;
}

Located located() {
    Located found;
    found.position = {{40, 40}, {47, 40}, {5, 40}, {60, 60}};
    found.error.assign(4, {0.3, 0.4});
    found.residual = {0.005, 0.025, 0.025, 0.05};
    found.edge_residual = {0.006, 0.03, 0.03, 0.04};
    found.noise = 0.01;
    found.correlation = 4;
    found.fitted = found.position;
    return found;
}

TEST(CorrectedPositions, GivesTheErrorsThatRemainInTheClass) {
    Located found = located();
    correct_bias(correction(0), noise(1), noise(2), kDiameter, found, 1);
    EXPECT_EQ(found.position, located().position);
    const std::vector<Vec2> errors = standard_errors(found);
    // Nearest at .7 a, residual below .01: class 4; below .03: class 6; alone, above: class 15.
    EXPECT_NEAR(errors[0].x, 0.005 * kDiameter, 1e-12);
    EXPECT_NEAR(errors[1].y, 0.007 * kDiameter, 1e-12);
    EXPECT_NEAR(errors[3].x, 0.016 * kDiameter, 1e-12);
}

TEST(CorrectedPositions, OfManyCamerasLeavesAShareOfEachErrorAndNeverLessThanTheNoise) {
    Located found = located();
    const std::vector<Vec2> before = standard_errors(found);
    BiasCorrection general = correction(0);
    general.shares = {0.8, 0.5, 0.6, 1e-9};
    correct_bias(general, noise(1), noise(2), kDiameter, found, 1);
    const std::vector<Vec2> after = standard_errors(found);
    EXPECT_NEAR(after[1].x, 0.5 * before[1].x, 1e-12);  // .7 a from its neighbour
    EXPECT_NEAR(after[1].y, 0.5 * before[1].y, 1e-12);
    EXPECT_NEAR(after[3].x, 0.3 * found.noise, 1e-12);  // alone: what the camera's noise makes
    EXPECT_EQ(after[2], before[2]);                     // at the border
}

TEST(CorrectedPositions, OfManyCamerasDoubtsEachAxisInProportionToItsShift) {
    Located found = located();
    const std::vector<Vec2> before = standard_errors(found);
    BiasCorrection general = correction(1);
    general.shares = {0.8, 0.5, 0.6, 1e-9};
    general.doubt = 0.4;
    correct_bias(general, noise(1), noise(2), kDiameter, found, 1);
    const std::vector<Vec2> after = standard_errors(found);
    const Vec2 shift = found.position[1] - located().position[1];
    ASSERT_GT(std::abs(shift.x), 0.01 * before[1].x);
    EXPECT_NEAR(after[1].x, std::hypot(0.5 * before[1].x, 0.4 * shift.x), 1e-12);
    EXPECT_NEAR(after[1].y, std::hypot(0.5 * before[1].y, 0.4 * shift.y), 1e-12);
    // Alone: of the first term what the camera's noise makes remains.
    const Vec2 moved = found.position[3] - located().position[3];
    EXPECT_NEAR(after[3].x, std::hypot(0.3 * found.noise, 0.4 * moved.x), 1e-12);
    EXPECT_EQ(after[2], before[2]);  // at the border
}

TEST(CorrectedPositions, LeavesSpheresAtTheBorderAsTheyAre) {
    Located found = located();
    correct_bias(correction(1), noise(1), noise(2), kDiameter, found, 1);
    EXPECT_EQ(found.position[2], located().position[2]);
    EXPECT_EQ(found.error[2], located().error[2]);
    EXPECT_NE(found.position[0], located().position[0]);
}

TEST(CorrectedPositions, HasTheSameBitsForAnyNumberOfThreads) {
    Located one = located();
    Located four = located();
    for (int k = 0; k < 200; ++k) {
        const Vec2 p{15 + 0.2 * k, 40 + 10 * std::sin(0.3 * k)};
        for (Located* l : {&one, &four}) {
            l->position.push_back(p);
            l->fitted.push_back(p);
            l->error.push_back({1, 1});
            l->residual.push_back(0.02);
            l->edge_residual.push_back(0.02);
        }
    }
    correct_bias(correction(1), noise(1), noise(2), kDiameter, one, 1);
    correct_bias(correction(1), noise(1), noise(2), kDiameter, four, 4);
    EXPECT_EQ(one.position, four.position);
    EXPECT_EQ(one.error, four.error);
}

// Checkpoints, and parts of a film, are told apart by these numbers.
TEST(BiasCorrectionNumbers, DifferWhereAnythingThatMakesPositionsOrErrorsDoes) {
    const BiasCorrection one = correction(1);
    EXPECT_EQ(numbers_of(one), numbers_of(correction(1)));
    BiasCorrection other = one;
    other.doubt = 0.2;
    EXPECT_NE(numbers_of(one), numbers_of(other));
    for (auto part : {&BiasCorrection::weights, &BiasCorrection::quality,
                      &BiasCorrection::remaining, &BiasCorrection::shares}) {
        other = one;
        (other.*part).push_back(0.5);
        EXPECT_NE(numbers_of(one), numbers_of(other));
    }
}

TEST(StandardErrors, HoldNoiseAndCorrelatedMisfit) {
    const std::vector<Vec2> errors = standard_errors(located());
    // Below the noise there is no misfit.
    EXPECT_NEAR(errors[0].x, 0.3 * 0.01, 1e-12);
    // What is left at the edge counts: .03.
    EXPECT_NEAR(errors[1].y, 0.4 * std::sqrt(1e-4 + 4 * (9e-4 - 1e-4)), 1e-12);
}

}  // namespace
}  // namespace grainfield::tracking
