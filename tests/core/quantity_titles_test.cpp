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

TEST(QuantityTitles, AreTheNamesWithSpacesWhereNobodyGivesThem) {
    EXPECT_EQ(quantity_title({}, "msd", "d_all"), "d all");
    EXPECT_EQ(observable_title({}, "my_own"), "my own");
}

}  // namespace
}  // namespace grainfield
