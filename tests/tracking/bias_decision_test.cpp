#include "tracking/bias_decision.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield::tracking {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(BiasDecision, NamesOfSourcesAreReadAgain) {
    for (const BiasSource source : {BiasSource::none, BiasSource::general, BiasSource::film}) {
        EXPECT_EQ(bias_source_named(name_of(source)), source);
    }
    EXPECT_FALSE(bias_source_named("camera").has_value());
}

TEST(BiasDecision, SaysByHowMuchPositionsWereMovedAndWhatIsKnownOfTheirErrors) {
    const BiasDecision general{.source = BiasSource::general,
                               .cameras = 320,
                               .moved = 0.0108,
                               .before = 0.0169,
                               .after = 0.0083,
                               .reason = {}};
    EXPECT_THAT(in_words(general), HasSubstr("by 0.0108 a RMS"));
    EXPECT_THAT(in_words(general), HasSubstr("320 other cameras"));
    EXPECT_THAT(in_words(general), HasSubstr("from 0.0169 to 0.0083 a"));
    const BiasDecision film{
        .source = BiasSource::film, .moved = {}, .before = 0.0183, .after = 0.0099, .reason = {}};
    EXPECT_THAT(in_words(film), HasSubstr("0.0183 to 0.0099 a RMS"));
}

TEST(BiasDecision, SaysWhyPositionsAreThoseOfTheDiscs) {
    const BiasDecision none{.moved = {}, .reason = "bright spheres mirror no panel"};
    EXPECT_THAT(in_words(none), StartsWith("not corrected"));
    EXPECT_THAT(in_words(none), HasSubstr("bright spheres mirror no panel"));
}

}  // namespace
}  // namespace grainfield::tracking
