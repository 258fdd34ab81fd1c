#include "pipelines/track/stored_bias.h"

#include <limits>

#include <gtest/gtest.h>

namespace grainfield::pipelines {
namespace {

using tracking::BiasDecision;
using tracking::BiasSource;

BiasDecision general() {
    return {.source = BiasSource::general,
            .cameras = 320,
            .moved = 0.0108,
            .before = 0.0169,
            .after = 0.0083,
            .reason = {}};
}

TEST(StoredBias, IsReadAsItWasDecided) {
    const BiasDecision film{
        .source = BiasSource::film, .moved = {}, .before = 0.0183, .after = 0.0099, .reason = {}};
    const BiasDecision none{.moved = {}, .reason = "bright spheres mirror no panel"};
    for (const BiasDecision& decision : {general(), film, none}) {
        const auto found = stored_bias({curve_of(decision)});
        ASSERT_TRUE(found.has_value());
        EXPECT_EQ(*found, decision);
    }
}

TEST(StoredBias, OfATrajectoryThatDoesNotSayIsEmpty) {
    EXPECT_FALSE(stored_bias({}).has_value());
    Curve other = curve_of(general());
    other.name = "camera";
    EXPECT_FALSE(stored_bias({other}).has_value());
}

TEST(StoredBias, ThatIsDamagedIsEmpty) {
    Curve unnamed = curve_of(general());
    unnamed.text_columns["source"] = {"witchcraft"};
    EXPECT_FALSE(stored_bias({unnamed}).has_value());
    Curve without_words = curve_of(general());
    without_words.text_columns.clear();
    EXPECT_FALSE(stored_bias({without_words}).has_value());
    Curve unknown = curve_of(general());
    unknown.columns[2].values = {std::numeric_limits<double>::quiet_NaN()};
    EXPECT_FALSE(stored_bias({unknown}).has_value());
    Curve negative = curve_of(general());
    negative.columns[3].values = {-1};
    EXPECT_FALSE(stored_bias({negative}).has_value());
    Curve empty = curve_of(general());
    for (Column& column : empty.columns) column.values.clear();
    EXPECT_FALSE(stored_bias({empty}).has_value());
}

}  // namespace
}  // namespace grainfield::pipelines
