#include "analysis/observables.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield::analysis {
namespace {

std::vector<std::string> names(const std::vector<Observable>& list) {
    std::vector<std::string> names;
    for (const Observable& observable : list) names.push_back(observable.name);
    return names;
}

TEST(Observables, AreChosenByNameInTheOrderOfTheirResults) {
    EXPECT_THAT(names(chosen({"sk", "q4"}, observables())), testing::ElementsAre("q4", "sk"));
    EXPECT_EQ(names(chosen({"all"}, observables())), names(observables()));
}

TEST(Observables, RefuseUnknownNamesWithTheNearestOne) {
    try {
        chosen({"q4", "varience"}, observables());
        FAIL() << "accepted";
    } catch (const OptionError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("did you mean variance"));
        EXPECT_THAT(error.what(), testing::HasSubstr("'varience'"));
        EXPECT_THAT(error.what(), testing::HasSubstr("synthetic"));
    }
    EXPECT_THROW(chosen({}, observables()), OptionError);
}

TEST(Observables, HaveNamesAndFiguresOfTheirOwn) {
    std::vector<std::string> all = names(observables());
    std::ranges::sort(all);
    EXPECT_EQ(std::ranges::adjacent_find(all), all.end());
    std::vector<std::string> figures;
    for (const FigureHint& hint : figure_hints()) {
        figures.push_back(hint.name);
        ASSERT_FALSE(hint.series.empty()) << hint.name;
        EXPECT_NE(hint.title, "") << hint.name;
        EXPECT_NE(hint.x.label, "") << hint.name;
        EXPECT_NE(hint.y.label, "") << hint.name;
    }
    std::ranges::sort(figures);
    EXPECT_EQ(std::ranges::adjacent_find(figures), figures.end());
    EXPECT_THAT(figures, testing::IsSupersetOf({"q4_histogram", "sk", "msd", "variance"}));
}

TEST(Observables, SayWhatTheirNumbersAreCalled) {
    const std::vector<ObservableTitles> known = titles();
    std::vector<std::string> named;
    for (const ObservableTitles& own : known) {
        named.push_back(own.name);
        EXPECT_NE(own.title, own.name);
        std::vector<std::string> quantities;
        for (const QuantityTitle& quantity : own.quantities) quantities.push_back(quantity.name);
        std::ranges::sort(quantities);
        EXPECT_EQ(std::ranges::adjacent_find(quantities), quantities.end()) << own.name;
    }
    EXPECT_THAT(named, testing::IsSupersetOf(names(observables())));
    EXPECT_THAT(named, testing::IsSupersetOf({"field", "sk_order", "series", "critical"}));
}

TEST(Observables, NameTheOrderAfterItsSymmetry) {
    EXPECT_EQ(quantity_title(titles(), "q4", "q4_mean"), "Mean |Q₄|");
    EXPECT_EQ(quantity_title(titles(), "q4", "q6_minimum"), "|Q₆| between the peaks");
    EXPECT_EQ(quantity_title(titles(), "q4", "q12_low_mode"), "|Q₁₂| of the liquid peak");
}

}  // namespace
}  // namespace grainfield::analysis
