#include "pipelines/tune/tune_alternatives.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/disc_sequence.h"

namespace grainfield::pipelines {
namespace {

report::Alternatives alternatives(const tracking::TrackOptions& options) {
    Frame frame;
    frame.image = testing::disc_frame(testing::few_discs(), 0);
    frame.status = FrameStatus::ok;
    Job job;
    return tuned_alternatives(frame, tracking::Polarity::dark, testing::kApparentDiameter, 0.05,
                              options, job);
}

TEST(TuneAlternatives, AreTriedForBothPolaritiesAllDiametersAndThresholds) {
    const report::Alternatives all = alternatives({});
    EXPECT_EQ(all.tried.size(), 2U * 7 * 4);
    EXPECT_EQ(all.tried.size(),
              all.axes[0].values.size() * all.axes[1].values.size() * all.axes[2].values.size());
    const report::Alternative& own = all.tried[3 * 4 + 1];
    EXPECT_EQ(own.position.size(), testing::few_discs().position.size()) << own.words;
}

TEST(TuneAlternatives, AreTheSameForAFilmWhoseBiasIsCorrected) {
    tracking::TrackOptions corrected;
    corrected.sphere_diameter = 10;
    corrected.layers.height = 1.7;
    tracking::TrackOptions plain = corrected;
    corrected.correct_bias = true;
    const report::Alternatives with = alternatives(corrected);
    const report::Alternatives without = alternatives(plain);
    ASSERT_EQ(with.tried.size(), without.tried.size());
    for (std::size_t i = 0; i < with.tried.size(); ++i) {
        EXPECT_EQ(with.tried[i].position, without.tried[i].position);
        EXPECT_EQ(with.tried[i].words, without.tried[i].words);
    }
}

}  // namespace
}  // namespace grainfield::pipelines
