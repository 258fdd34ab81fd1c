#include "tracking/model/known_models.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "tracking/calibrate/calibration_options.h"
#include "tracking/model/blurred_union.h"
#include "tracking/model/tanh_edge.h"

namespace grainfield::tracking {
namespace {

TEST(KnownModels, SavedStatesReferToTheirOrder) {
    EXPECT_EQ(number_of(kTanhEdge), 0U);
    EXPECT_EQ(number_of(kProductRule), 0U);
    EXPECT_EQ(number_of(kBlurredUnion), 1U);
}

TEST(KnownModels, APartThatIsNotListedHasNoNumber) {
    const ProductRule other;
    EXPECT_THROW(number_of(other), std::out_of_range);
}

TEST(KnownModels, EachIsAChoiceOfTheOptionTable) {
    CalibrationOptions options;
    const OptionTable table = describe(options);
    for (const OverlapRule* rule : overlap_rules()) {
        table.set("meeting-edges", std::string(rule->name()));
        EXPECT_EQ(options.meeting_edges, rule);
    }
    for (const ProfileShape* shape : profile_shapes()) {
        table.set("profile", std::string(shape->name()));
        EXPECT_EQ(options.profile.shape, shape);
        EXPECT_EQ(options.profile.learning, Learning::never);
    }
    table.set("meeting-edges", std::string("auto"));
    EXPECT_EQ(options.meeting_edges, nullptr);
    table.set("profile", std::string("learned"));
    EXPECT_EQ(options.profile, (ProfileChoice{&kTanhEdge, Learning::always}));
}

TEST(KnownModels, NoTwoChoicesHaveOneName) {
    std::set<std::string_view> names{"auto", "learned"};
    for (const ProfileShape* shape : profile_shapes()) {
        EXPECT_TRUE(names.insert(shape->name()).second) << shape->name();
    }
    names = {"auto"};
    for (const OverlapRule* rule : overlap_rules()) {
        EXPECT_TRUE(names.insert(rule->name()).second) << rule->name();
    }
}

}  // namespace
}  // namespace grainfield::tracking
