#include "report/page/absences.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield::report {
namespace {

using testing::HasSubstr;

Results one_frame() {
    Results run;
    run.frames = 1;
    run.observables.resize(2);
    run.observables[0].name = "msd";
    run.observables[0].reason = "one frame: nothing has moved yet";
    run.observables[1].name = "q4";
    run.observables[1].measurements = {
        {"q4_mean", "-", 0.4, 0.1, 9, ""},
        {"order_length", "a", std::nullopt, std::nullopt, 0, "no <decay>"}};
    return run;
}

// Nine frames whose fit has one number, and lacks these for these reasons.
Results without(const std::vector<std::pair<std::string, std::string>>& numbers) {
    Results run;
    run.frames = 9;
    run.observables.resize(1);
    ObservableResult& fit = run.observables[0];
    fit.name = "fit";
    for (const auto& [name, reason] : numbers) {
        fit.measurements.push_back({name, "-", std::nullopt, std::nullopt, 0, reason});
    }
    fit.measurements.push_back({"h", "-", 1.0, std::nullopt, 0, ""});
    return run;
}

const std::vector<ObservableTitles> titles{
    {"msd", "Displacement", {}}, {"q4", "Order", {{"order_length", "Length of the order"}}}};

TEST(Absences, TellWhatMoreFramesWouldBringFromTheRest) {
    const std::vector<Absent> all = absences(one_frame(), titles);
    ASSERT_EQ(all.size(), 2U);
    EXPECT_EQ(all[0].what, "displacement");
    EXPECT_TRUE(all[0].one_frame);
    EXPECT_EQ(all[1].what, "length of the order");
    EXPECT_FALSE(all[1].one_frame);
}

TEST(AbsencesHtml, IsOneLineWithReasonsToUnfold) {
    const std::string html = absences_html({one_frame()}, {"A"}, titles);
    EXPECT_THAT(html, HasSubstr("<summary>Not possible with one frame: displacement. Not measured: "
                                "length of the order.</summary>"));
    EXPECT_THAT(html, HasSubstr("<li>length of the order: no &lt;decay&gt;</li>"));
}

TEST(AbsencesHtml, OfSeveralRunsIsOneLineAndTheReasonsSayWhose) {
    Results complete = one_frame();
    complete.observables[0].reason.clear();
    const std::string html =
        absences_html({one_frame(), one_frame(), complete}, {"A", "B", "C"}, titles);
    EXPECT_THAT(html, HasSubstr("<summary>Not possible with one frame: displacement. Not "));
    EXPECT_THAT(html, HasSubstr("<li>A, B: displacement: one frame"));
    EXPECT_THAT(html, HasSubstr("<li>length of the order: no")) << "of all three";
    EXPECT_EQ(html.find("<details"), html.rfind("<details"));
}

TEST(AbsencesHtml, OfManyNumbersNamesAFew) {
    const Results run = without({{"a", "no a"},
                                 {"b", "no b"},
                                 {"c", "no c"},
                                 {"d", "no d"},
                                 {"e", "no e"},
                                 {"f", "no f"},
                                 {"g", "no g"}});
    const std::string html = absences_html({run}, {"A"}, {});
    EXPECT_THAT(html, HasSubstr("<summary>Not measured: a, b, c, d and 3 more.</summary>"));
    EXPECT_THAT(html, HasSubstr("<li>g: no g</li>"));
}

TEST(AbsencesHtml, SaysOneReasonOfSeveralNumbersOnce) {
    const Results run = without({{"a", "it grows"}, {"b", "it grows"}, {"c", "too few"}});
    const std::string html = absences_html({run}, {"A"}, {});
    EXPECT_THAT(html, HasSubstr("<li>a, b: it grows</li>"));
    EXPECT_THAT(html, HasSubstr("<li>c: too few</li>"));
}

TEST(Absences, NameAnObservableOnceWhereMostOfItIsMissingForOneReason) {
    const std::vector<Absent> all = absences(without({{"s0", "no maximum"},
                                                      {"s1", "no maximum"},
                                                      {"alpha", "no maximum"},
                                                      {"k_pre_peak", "none stands out"}}),
                                             {});
    ASSERT_EQ(all.size(), 2U);
    EXPECT_EQ(all[0].what, "fit");
    EXPECT_EQ(all[0].reason, "no maximum");
    EXPECT_EQ(all[1].what, "k pre peak");
}

TEST(AbsencesHtml, OfACompleteRunIsEmpty) {
    Results run = one_frame();
    run.observables.erase(run.observables.begin());
    run.observables[0].measurements.pop_back();
    EXPECT_EQ(absences_html({run}, {"A"}, titles), "");
}

}  // namespace
}  // namespace grainfield::report
