#include "tracking/calibrate/size_trials.h"

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

Image liquid(int width) {
    return testing::tanh_frame(testing::hard_disc_liquid(width, width, 16, 0.6, 1), 16, 1.2, 0.02,
                               2);
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

TEST(SizeTrials, WithoutDiscsHaveNoBestOne) {
    const Image counts = testing::noise_frame(200, 200, 120, 30, 3, 1);
    RunPlan plan;
    std::vector<SizeCandidate> weighed;
    EXPECT_FALSE(best_trial(counts, fit_of(counts), plan, weighed));
    ASSERT_EQ(plan.warnings().size(), 1U);
}

}  // namespace
}  // namespace grainfield::tracking
