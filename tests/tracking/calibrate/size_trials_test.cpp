#include "tracking/calibrate/size_trials.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/layer_frames.h"

namespace grainfield::tracking {
namespace {

ModelFit fit_of(const Image& counts, const CalibrationOptions& options = {}) {
    return {.options = options,
            .detection = {},
            .refinement = {},
            .threads = 2,
            .levels = levels_of(counts)};
}

Image liquid(int width, double diameter = 16) {
    return testing::tanh_frame(testing::hard_disc_liquid(width, width, diameter, 0.6, 1), diameter,
                               1.2, 0.02, 2);
}

TEST(SizeTrials, TakeASmallFrameAsAWhole) {
    const Image counts = liquid(300);
    RunPlan plan;
    std::vector<SizeCandidate> weighed;
    const auto best = best_trial(counts, fit_of(counts), plan, weighed);
    ASSERT_TRUE(best);
    EXPECT_TRUE(best->is_whole);
    EXPECT_EQ(best->candidate.width, 300);
    EXPECT_EQ(best->polarity, Polarity::dark);
    EXPECT_NEAR(best->candidate.diameter, 16, 0.3);
    ASSERT_EQ(weighed.size(), 1U) << "the first guess needs no rival";
    EXPECT_EQ(weighed[0].diameter, best->candidate.diameter);
}

TEST(SizeTrials, LookAtAPartOfALargeFrame) {
    // The part is 30 diameters wide, and a frame that is half as large again is not a whole.
    const Image counts = liquid(800);
    RunPlan plan;
    std::vector<SizeCandidate> weighed;
    const auto best = best_trial(counts, fit_of(counts), plan, weighed);
    ASSERT_TRUE(best);
    EXPECT_FALSE(best->is_whole);
    const SizeCandidate& part = best->candidate;
    // First guesses of a diameter err by .16 of it and 1 px at most (first_guess_test).
    EXPECT_NEAR(part.width, 30 * 16, 30 * (0.16 * 16 + 1));
    EXPECT_EQ(part.width, part.height);
    for (const Vec2 p : part.position) {
        // Discs that the border of the part cuts lie within a diameter of it.
        EXPECT_GT(p.x, part.x - 16);
        EXPECT_LT(p.x, part.x + part.width + 16);
        EXPECT_GT(p.y, part.y - 16);
        EXPECT_LT(p.y, part.y + part.height + 16);
    }
}

/// The left of a liquid, and beyond it structures of 3 px that are no discs and darker on average.
Image liquid_beside(int width, int liquid_width, double diameter) {
    Image counts = liquid(width, diameter);
    const Image texture = testing::noise_frame(width, width, 0, 1, 1, 3);
    for (int y = 1; y + 1 < width; ++y) {
        for (int x = liquid_width; x + 1 < width; ++x) {
            double sum = 0;
            for (int v = -1; v <= 1; ++v) {
                for (int u = -1; u <= 1; ++u) sum += static_cast<double>(texture(x + u, y + v));
            }
            counts(x, y) = static_cast<float>(std::clamp(40 + 12 * sum, 30.0, 200.0));
        }
    }
    return counts;
}

TEST(SizeTrials, LookAtASmallerPartWhereWhatIsNoDiscReachesIntoEveryPart) {
    // Parts are 256 px and 128 px wide.
    const Image counts = liquid_beside(400, 150, 8);
    RunPlan plan;
    std::vector<SizeCandidate> weighed;
    const auto best = best_trial(counts, fit_of(counts), plan, weighed);
    ASSERT_TRUE(best) << in_words(weighed);
    EXPECT_FALSE(weighed.front().explained.signal >= kLeastExplained) << "of the usual part";
    EXPECT_EQ(best->polarity, Polarity::dark);
    EXPECT_NEAR(best->candidate.diameter, 8, 0.2);
    EXPECT_NEAR(best->candidate.width, 15 * 8, 15 * (0.16 * 8 + 1));
    EXPECT_GT(best->candidate.explained.signal, 0.95);
    ASSERT_EQ(plan.warnings().size(), 1U) << "what is no disc is filled with discs";
    EXPECT_THAT(plan.warnings()[0].text, ::testing::HasSubstr("is that of a clear part"));
}

TEST(SizeTrials, WithoutDiscsHaveNoBestOne) {
    const Image counts = testing::noise_frame(200, 200, 120, 30, 3, 1);
    RunPlan plan;
    std::vector<SizeCandidate> weighed;
    EXPECT_FALSE(best_trial(counts, fit_of(counts), plan, weighed));
    ASSERT_EQ(plan.warnings().size(), 1U);
}

}  // namespace
}  // namespace grainfield::tracking
