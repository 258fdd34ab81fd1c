#include "pipelines/tune/tune_alternatives.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/disc_sequence.h"

namespace grainfield::pipelines {
namespace {

report::Alternatives alternatives(const tracking::TrackOptions& options,
                                  const FilmOptions& film = {}) {
    Frame frame;
    frame.image = testing::disc_frame(testing::few_discs(), 0);
    frame.status = FrameStatus::ok;
    Job job;
    return tuned_alternatives(frame, tracking::Polarity::dark, testing::kApparentDiameter, 0.05,
                              options, film, job);
}

TEST(TuneAlternatives, AreTriedForBothPolaritiesAllDiametersAndThresholds) {
    const report::Alternatives all = alternatives({});
    EXPECT_EQ(all.tried.size(), 2U * 7 * 4);
    EXPECT_EQ(all.tried.size(),
              all.axes[0].values.size() * all.axes[1].values.size() * all.axes[2].values.size());
    const report::Alternative& own = all.tried[3 * 4 + 1];
    EXPECT_EQ(own.position.size(), testing::few_discs().position.size()) << own.words;
}

TEST(TuneAlternatives, HaveSettingsThatKeepWhatTheUserGave) {
    tracking::TrackOptions options;
    options.sphere_diameter = 10;
    options.layers.height = 1.7;
    FilmOptions film;
    film.region = {2, 3, 100, 90};
    film.background = "running";
    const report::Alternatives all = alternatives(options, film);
    for (const report::Alternative& one : {all.tried.front(), all.tried.back()}) {
        for (const char* line : {"\nregion = \"2,3,100,90\"\n", "\nbackground = \"running\"\n",
                                 "\nheight = 1.7\n", "\nsphere-diameter = 10\n"}) {
            EXPECT_THAT(one.settings, ::testing::HasSubstr(line));
        }
    }
    EXPECT_THAT(all.tried.front().settings, ::testing::HasSubstr("\npolarity = \"dark\"\n"));
    EXPECT_THAT(all.tried.back().settings, ::testing::HasSubstr("\npolarity = \"bright\"\n"));
    EXPECT_THAT(all.tried.front().settings, ::testing::HasSubstr("\nevidence = 0.025\n"));
    EXPECT_THAT(all.tried.back().settings, ::testing::HasSubstr("\nevidence = 0.200\n"));
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
