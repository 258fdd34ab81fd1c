#include "core/run_identity.h"

#include <gtest/gtest.h>

namespace grainfield {
namespace {

RunIdentity with_gamma(Origin origin, double value) {
    return {.origin = origin,
            .control = ControlValue{.parameter = ControlParameter::acceleration, .value = value}};
}

TEST(RunIdentity, IsNamedAfterItsSeriesAndItsControlParameter) {
    EXPECT_EQ(legend_of(with_gamma(Origin::md, 2.25)), "MD, Γ = 2.25");
    EXPECT_EQ(legend_of(with_gamma(Origin::rendered, 4.73)), "true positions, Γ = 4.73");
    EXPECT_EQ(legend_of({.origin = Origin::video}), "tracked");
    EXPECT_EQ(legend_of({}), "points");
}

TEST(RunIdentity, OfAFieldNamesDimensionAndGradientOrder) {
    const RunIdentity field{
        .origin = Origin::field,
        .control = ControlValue{.parameter = ControlParameter::critical_distance, .value = 0.002},
        .dimension = 1,
        .gradient_order = 4};
    EXPECT_EQ(legend_of(field), "field, 1D, b = 4, ν = 0.002");
    EXPECT_TRUE(field.is_field());
    EXPECT_EQ(series_text({.origin = Origin::field}), "field, 2D");
}

TEST(RunIdentity, NamesTheUnitOfAControlParameterThatHasOne) {
    RunIdentity identity = with_gamma(Origin::md, 3);
    identity.control->unit = "a";
    EXPECT_EQ(legend_of(identity), "MD, Γ = 3 a");
}

TEST(Series, HoldsRunsThatDifferInTheControlParameterAlone) {
    EXPECT_TRUE(same_series(with_gamma(Origin::md, 2), with_gamma(Origin::md, 3)));
    EXPECT_FALSE(same_series(with_gamma(Origin::md, 2), with_gamma(Origin::video, 2)));
    const RunIdentity plane{.origin = Origin::field, .gradient_order = 4};
    for (const RunIdentity& other :
         {RunIdentity{.origin = Origin::field, .gradient_order = 2},
          RunIdentity{.origin = Origin::field, .dimension = 1, .gradient_order = 4},
          RunIdentity{
              .origin = Origin::field, .role = RunRole::critical_point, .gradient_order = 4}}) {
        EXPECT_FALSE(same_series(plane, other));
    }
}

}  // namespace
}  // namespace grainfield
