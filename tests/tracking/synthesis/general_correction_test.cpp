#include "tracking/synthesis/general_correction.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/run_plan.h"
#include "tests/support/layer_frames.h"
#include "tests/tracking/synthesis/rendered_layer.h"
#include "tracking/calibrate/calibration.h"
#include "tracking/locate.h"
#include "tracking/synthesis/bias_terms.h"
#include "tracking/synthesis/corrected_positions.h"

namespace grainfield::tracking {
namespace {

using ::testing::HasSubstr;

TEST(GeneralCorrection, OfTheProgramSaysThatItIsOfManyCamerasAndHalvesTheirErrors) {
    const GeneralCorrection& general = general_correction();
    EXPECT_EQ(general.weights.size(), static_cast<std::size_t>(BiasTerms::kCount));
    EXPECT_GE(general.cameras, 100);
    EXPECT_LT(general.after, 0.6 * general.before);
    for (const double share : general.shares) {
        EXPECT_GT(share, 0.3);
        EXPECT_LE(share, 1);
    }
    EXPECT_GT(general.doubt, 0.1);
    EXPECT_LT(general.doubt, 0.9);
}

TEST(GeneralCorrection, IsReadAsItIsWritten) {
    const std::string text = write_general_correction(general_correction());
    const GeneralCorrection again = read_general_correction(text);
    EXPECT_EQ(write_general_correction(again), text);
    EXPECT_EQ(again.weights, general_correction().weights);
    EXPECT_EQ(again.shares, general_correction().shares);
    EXPECT_EQ(again.doubt, general_correction().doubt);
}

TEST(GeneralCorrection, RefusesATextThatIsCutOffOrHoldsNoNumbers) {
    std::string text = write_general_correction(general_correction());
    EXPECT_THROW(read_general_correction(text.substr(0, text.size() / 2)), std::invalid_argument);
    EXPECT_THROW(read_general_correction("learned-from a few\n"), std::invalid_argument);
}

TEST(GeneralCorrection, WeightsAreThoseOfTheDiscsThatTheyAreFor) {
    const GeneralCorrection& general = general_correction();
    const double a = 12;
    const BiasCorrection sharp = general.of({0.9 * a, 0.09 * a}, a);
    const auto film = GeneralCorrection::film_terms(0.09, 0.9);
    for (const std::size_t k : {0U, 11U, 30U, 809U}) {
        const auto& w = general.weights[k];
        EXPECT_NEAR(sharp.weights[k], w[0] * film[0] + w[1] * film[1] + w[2] * film[2], 1e-12);
    }
    EXPECT_TRUE(sharp.is_general());
    EXPECT_EQ(sharp.shares, general.shares);
    EXPECT_EQ(sharp.doubt, general.doubt);
}

TEST(GeneralCorrection, TellsTheMeanPatternOfEitherKindFromTheOther) {
    const GeneralCorrection& general = general_correction();
    ResidualPattern::Numbers mirrors{};
    ResidualPattern::Numbers rims{};
    std::copy(general.mirrors.mean.begin(), general.mirrors.mean.end(), mirrors.begin());
    std::copy(general.rims.mean.begin(), general.rims.mean.end(), rims.begin());
    EXPECT_EQ(general.unlikeness(mirrors), 0);
    EXPECT_GT(general.unlikeness(rims), 3);
    EXPECT_GT(general.log_odds(mirrors), 5);
    EXPECT_LT(general.log_odds(rims), -5);
}

// Two kinds on one number: ln of the ratio of two normal densities.
TEST(GeneralCorrection, LogOddsAreThoseOfTwoNormalDistributions) {
    constexpr std::size_t n = ResidualPattern::kNumbers;
    GeneralCorrection general;
    general.mirrors = {std::vector<double>(n, 0.0), std::vector<double>(n * n, 0.0), 0};
    general.rims = general.mirrors;
    general.rims.mean[0] = 2;
    general.mirrors.weights[0] = 1 / (0.5 * 0.5);
    general.mirrors.log_determinant = 2 * std::log(0.5);
    general.rims.weights[0] = 1 / (3.0 * 3.0);
    general.rims.log_determinant = 2 * std::log(3.0);
    const auto density = [](double x, double mean, double sigma) {
        return std::exp(-0.5 * (x - mean) * (x - mean) / (sigma * sigma)) / sigma;
    };
    for (const double x : {-1.0, 0.3, 1.5}) {
        ResidualPattern::Numbers numbers{};
        numbers[0] = x;
        EXPECT_NEAR(general.log_odds(numbers), std::log(density(x, 0, 0.5) / density(x, 2, 3)),
                    1e-12);
        EXPECT_NEAR(general.unlikeness(numbers), std::abs(x) / 0.5 / std::sqrt(double{n}), 1e-12);
    }
}

TEST(ResidualPattern, IsOfTheRingsWithinASphereAndOfTheMisfit) {
    BiasTerms::Terms terms{};
    constexpr std::size_t first = BiasTerms::kDistances;
    for (std::size_t ring = 0; ring < BiasTerms::kRings; ++ring) {
        terms.x[first + ring] = ring % 2 == 0 ? 1.0F : -2.0F;
    }
    ResidualPattern pattern;
    pattern.add(terms);
    const auto numbers = pattern.numbers(0.05);
    for (std::size_t ring = 0; ring + 1 < ResidualPattern::kRings; ++ring) {
        EXPECT_NEAR(numbers[ring], -1, 1e-12);
    }
    const double mean = (3 * 1.0 + 2 * 4.0) / 5;
    for (std::size_t ring = 0; ring < ResidualPattern::kRings; ++ring) {
        const double square = ring % 2 == 0 ? 1 : 4;
        EXPECT_NEAR(numbers[ResidualPattern::kRings - 1 + ring], 0.5 * std::log(square / mean),
                    1e-12);
    }
    EXPECT_NEAR(numbers.back(), std::log(0.05), 1e-12);
    terms.x[first + ResidualPattern::kRings] = 1e3F;  // beyond the sphere
    ResidualPattern other;
    other.add(terms);
    EXPECT_EQ(other.numbers(0.05), numbers);
}

TEST(GeneralCorrection, DoesNotHoldForDiscsUnlikeThoseLearnedFrom) {
    const GeneralCorrection& general = general_correction();
    EXPECT_EQ(general.refused({0.88 * 16, 0.11 * 16}, 16), "");
    EXPECT_THAT(general.refused({0.88 * 16, 0.3 * 16}, 16), HasSubstr("edges are 0.300 a wide"));
    EXPECT_THAT(general.refused({0.6 * 16, 0.11 * 16}, 16), HasSubstr("discs are 0.600 a wide"));
}

// The spheres are fitted with a model that was not calibrated on them, and by a ray tracer whose
// frames it was not learned from.
TEST(GeneralCorrection, BringsTheMirrorsOfAnotherRayTracerNearerToTheirPlaces) {
    constexpr double kScale = 12;
    const auto layer = testing::rendered_layer(24, kScale, 0.01, 11);
    ImageModel model;
    model.disc = {0.89 * kScale, 0.12 * kScale};
    model.background = BackgroundSurface(1.0);
    model.dark_level = 0;
    model.noise = 0.01;
    model.residual_rms = 0.05;
    Locator locator(layer.brightness.width(), layer.brightness.height(), model, 2);
    locator.expect_misfit(model.residual_rms);
    const Image darkness = model.darkness(layer.brightness);
    Located found = locator.locate(darkness, {}, {});
    const auto error = [&] {
        double squares = 0;
        int values = 0;
        for (const Vec2 p : found.position) {
            double least = 0.04;
            for (const Point3& q : layer.spheres) {
                if (!layer.is_inner(q, 2)) continue;
                least = std::min(
                    least, squared_norm((1 / kScale) * p -
                                        Vec2{static_cast<double>(q.x), static_cast<double>(q.y)}));
            }
            if (least >= 0.04) continue;
            squares += least;
            values += 2;
        }
        EXPECT_GT(values, 400);
        return std::sqrt(squares / values);
    };
    // |error|/standard error along both axes of those that were moved by at least `least` standard
    // errors of the disc; the share that is 2 at most.
    const auto within = [&](const Located& corrected, double least_shift) {
        const std::vector<Vec2> discs = standard_errors(found);
        const std::vector<Vec2> errors = standard_errors(corrected);
        int values = 0;
        int in_two = 0;
        for (std::size_t i = 0; i < errors.size(); ++i) {
            const Vec2 p = corrected.position[i];
            Vec2 lack{1, 1};
            for (const Point3& q : layer.spheres) {
                if (!layer.is_inner(q, 2)) continue;
                const Vec2 d =
                    Vec2{static_cast<double>(q.x), static_cast<double>(q.y)} - (1 / kScale) * p;
                if (squared_norm(d) < squared_norm(lack)) lack = d;
            }
            if (squared_norm(lack) >= 0.04) continue;
            const Vec2 shift = p - found.position[i];
            const auto count = [&](double d, double sigma, double moved, double disc) {
                if (std::abs(moved) < least_shift * disc) return;
                ++values;
                in_two += std::abs(d) * kScale <= 2 * sigma;
            };
            count(lack.x, errors[i].x, shift.x, discs[i].x);
            count(lack.y, errors[i].y, shift.y, discs[i].y);
        }
        EXPECT_GT(values, 80);
        return static_cast<double>(in_two) / values;
    };
    const double before = error();
    const BiasCorrection correction = general_correction().of(model.disc, kScale);
    const GeneralCorrection& general = general_correction();
    const CorrectionJudgement two =
        judge_correction(general, layer.brightness, model, {}, {}, kScale, 2);
    EXPECT_GE(two.spheres, 200);
    EXPECT_GT(two.moved, 0.003);
    EXPECT_FALSE(two.is_too_large());
    EXPECT_FALSE(two.is_unlike()) << two.unlikeness;
    const CorrectionJudgement one =
        judge_correction(general, layer.brightness, model, {}, {}, kScale, 1);
    EXPECT_EQ(one.moved, two.moved);
    EXPECT_EQ(one.expected, two.expected);
    EXPECT_EQ(one.unlikeness, two.unlikeness);
    EXPECT_EQ(one.log_odds, two.log_odds);
    EXPECT_GT(two.log_odds, 0);
    Located corrected = found;
    correct_bias(correction, darkness, locator.residual(), kScale, corrected, 2);
    for (const double least_shift : {0.0, 1.0}) {
        EXPECT_GT(within(corrected, least_shift), 0.90) << least_shift;
        EXPECT_LT(within(corrected, least_shift), 0.99) << least_shift;
    }
    found = corrected;
    EXPECT_LT(error(), 0.75 * before);
}

// The frames of the reference camera have a mirroring rim, and errors as large as mirrors have.
TEST(CorrectionJudgement, OfDiscsWithARimIsThatTheyAreUnlikeMirrors) {
    const auto scene = testing::hard_disc_liquid(640, 640, 14, 0.7, 3);
    const Image counts = testing::camera_frame(scene, {}, 1);
    RunPlan plan;
    const auto calibration = calibrate(counts, {}, {}, {}, 2, plan);
    ASSERT_TRUE(calibration.has_value());
    const CorrectionJudgement judgement =
        judge_correction(general_correction(), counts, calibration->model, {}, {}, 16, 2);
    EXPECT_GE(judgement.spheres, 200);
    EXPECT_TRUE(judgement.is_unlike()) << judgement.unlikeness;
    EXPECT_LT(judgement.log_odds, CorrectionJudgement::kLeastOdds);
}

TEST(CorrectionJudgement, BesideErrorsThatAreZeroOrNotKnownIsThatItIsTooLarge) {
    CorrectionJudgement judgement{.spheres = 3, .moved = 0.01, .expected = 0.01};
    EXPECT_FALSE(judgement.is_too_large());
    judgement.expected = 0;
    EXPECT_TRUE(judgement.is_too_large());
    judgement.expected = std::nan("");
    EXPECT_TRUE(judgement.is_too_large());
    EXPECT_FALSE(judgement.is_unlike());
    judgement.log_odds = -1000;
    EXPECT_TRUE(judgement.is_unlike());
    judgement.log_odds = std::nan("");
    EXPECT_TRUE(judgement.is_unlike());
    judgement.log_odds = 0;
    judgement.unlikeness = std::nan("");
    EXPECT_TRUE(judgement.is_unlike());
}

}  // namespace
}  // namespace grainfield::tracking
