#include "app/validation_summary.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/random_summary.h"

namespace grainfield::app {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

pipelines::ValidationScores empty_scores() {
    pipelines::ScoredView view;
    view.width = view.height = 200;
    view.sphere_diameter = view.disc.diameter = 12;
    return pipelines::ValidationScores(view);
}

pipelines::ValidationOutcome outcome_of(const pipelines::ValidationScores& scores) {
    return {.scores = scores,
            .tracks = scores.tracks(),
            .runs = {},
            .free_fits = {},
            .effects = {},
            .msd_offset = std::nan(""),
            .predicted_msd_offset = std::nan("")};
}

TEST(ValidationSummary, ADashStandsForWhatCouldNotBeMeasured) {
    pipelines::ValidationScores scores = empty_scores();
    Snapshot truth;
    truth.position = {{60, 60}, {100.3, 100.2}};
    truth.id = {0, 1};
    scores.add(truth, {});  // nothing is found, twice
    scores.add(truth, {});
    const pipelines::ValidationOutcome outcome = outcome_of(scores);
    ASSERT_TRUE(std::isnan(scores.detection().find("all").precision()));
    const std::vector<pipelines::ThresholdCheck> checks{
        {"precision", "-", 0.9, scores.detection().find("all").precision(), true}};
    const std::string text = summary_text("page.html", outcome, checks);
    EXPECT_THAT(text, Not(HasSubstr("nan")));
    EXPECT_THAT(
        text,
        HasSubstr("all                4  0.00000          –         –      –      –       –\n"));
    EXPECT_EQ(missed_thresholds(checks),
              "thresholds missed: precision not measured, at least 0.9 asked for.");
}

TEST(ValidationSummary, SaysHowManyLayersAreNamedAndHowManyOfThemAreRight) {
    pipelines::ValidationScores scores = empty_scores();
    Snapshot truth;
    truth.position = {{60, 60}, {66, 60}, {72, 60}, {120, 120}};
    truth.box.length = {200, 200};
    truth.layer = {Layer::bottom, Layer::top, Layer::bottom, Layer::top};
    truth.id = {0, 1, 2, 3};
    Snapshot found = truth;
    found.layer = {Layer::bottom, Layer::top, Layer::top, Layer::unknown};
    scores.add(truth, found);
    const pipelines::ValidationOutcome outcome = outcome_of(scores);
    // Three in a row, one of them wrong: max(2, 1) − 1 of 3 − 1.
    EXPECT_THAT(
        summary_text("page.html", outcome, {}),
        HasSubstr("  layers    75.0 % of the spheres found are named; 50.00 % of the labels "
                  "are right, up to one exchange in each cluster\n"));
}

TEST(RandomSummary, ADashStandsForWhatNoSceneGave) {
    pipelines::RandomValidationResult result;
    pipelines::SceneScore lost;
    lost.spheres = lost.missed = 300;
    lost.rmse = lost.pull_rms = lost.within = lost.residual = lost.us_per_sphere = std::nan("");
    result.scenes = {lost};
    const std::string text = random_text("page.html", result);
    EXPECT_THAT(text, Not(HasSubstr("nan")));
    EXPECT_THAT(text, HasSubstr("–           –\n"));
    EXPECT_THAT(text, HasSubstr("all: 300 missed and 0 false of 300\n"));
}

}  // namespace
}  // namespace grainfield::app
