#include "core/quantity_titles.h"

#include <gtest/gtest.h>

namespace grainfield {
namespace {

const std::vector<ObservableTitles> titles{{"msd", "Displacement", {{"d_all", "Diffusion"}}},
                                           {"fit", "Fit of S(k)", {{"s0", "S₀"}}},
                                           {"fit", "Another", {{"s1", "S₁"}}}};

TEST(QuantityTitles, AreThoseOfTheObservableThatTheQuantityBelongsTo) {
    EXPECT_EQ(quantity_title(titles, "msd", "d_all"), "Diffusion");
    EXPECT_EQ(quantity_title(titles, "fit", "d_all"), "d all") << "not a number of the fit";
    EXPECT_EQ(quantity_title(titles, "fit", "s1"), "S₁");
    EXPECT_EQ(observable_title(titles, "fit"), "Fit of S(k)");
}

TEST(QuantityTitles, OfAFamilyHoldTheNumberOfTheName) {
    const std::vector<ObservableTitles> boxes{
        {"synthetic", "Boxes", {{"box_2", "The small box"}}, {{"box_", "Box of ", " a"}}}};
    EXPECT_EQ(quantity_title(boxes, "synthetic", "box_16.5"), "Box of 16.5 a");
    EXPECT_EQ(quantity_title(boxes, "synthetic", "box_2"), "The small box");
    EXPECT_EQ(quantity_title(boxes, "variance", "box_16.5"), "box 16.5");
}

TEST(QuantityTitles, AreTheNamesWithSpacesWhereNobodyGivesThem) {
    EXPECT_EQ(quantity_title({}, "msd", "d_all"), "d all");
    EXPECT_EQ(observable_title({}, "my_own"), "my own");
}

}  // namespace
}  // namespace grainfield
