#include "report/shared_times.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/lab_units.h"

namespace grainfield::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Results run(TimeUnit unit, Origin origin) {
    Results r;
    r.source.time_unit = unit;
    r.source.frame_rate = 100;
    r.identity.origin = origin;
    ObservableResult msd;
    msd.name = "msd";
    msd.measurements = {{"d_all", "a^2/time unit", 2, 0.5, 9, ""},
                        {"exponent_all", "-", 1, 0.1, 9, ""}};
    msd.curves = {{"msd", "", {{"t", "time unit", "", {1, 4}}, {"msd", "a^2", "", {3, 5}}}, {}}};
    r.observables = {msd};
    r.previews.emplace_back().snapshot.time = 10;
    return r;
}

void state(Results& r, double mm) {
    ObservableResult lengths;
    lengths.name = "lengths";
    lengths.measurements = {{"sphere_mm", "mm", mm, std::nullopt, 0, ""}};
    r.observables.push_back(lengths);
}

std::vector<Results> film_and_md() {
    return {run(TimeUnit::second, Origin::video), run(TimeUnit::sqrt_a_over_g, Origin::md)};
}

TEST(SharedTimes, AreSecondsWhereTheFilmKnowsItsSpheres) {
    std::vector<Results> runs = film_and_md();
    state(runs[0], 1);
    const std::string said = share_seconds(runs, std::nullopt);
    EXPECT_THAT(said, HasSubstr("√(a/g) = 10.1 ms for a = 1 mm"));
    const double s = std::sqrt(1e-3 / standard_gravity);
    EXPECT_EQ(runs[1].source.time_unit, TimeUnit::second);
    EXPECT_THAT(runs[1].observables[0].curves[0].columns[0].values, ElementsAre(s, 4 * s));
    EXPECT_THAT(runs[1].observables[0].curves[0].columns[1].values, ElementsAre(3, 5))
        << "lengths stay";
    EXPECT_DOUBLE_EQ(*runs[1].observables[0].measurements[0].value, 2 / s);
    EXPECT_DOUBLE_EQ(*runs[1].observables[0].measurements[0].error, 0.5 / s);
    EXPECT_EQ(*runs[1].observables[0].measurements[1].value, 1);
    EXPECT_DOUBLE_EQ(*runs[1].source.frame_rate, 100 / s);
    EXPECT_DOUBLE_EQ(runs[1].previews[0].snapshot.time, 10 * s);
    EXPECT_THAT(runs[0].observables[0].curves[0].columns[0].values, ElementsAre(1, 4))
        << "the film";
}

TEST(SharedTimes, TakeTheGivenDiameterFirst) {
    std::vector<Results> runs = film_and_md();
    state(runs[0], 1);
    EXPECT_THAT(share_seconds(runs, 4), HasSubstr("a = 4 mm"));
}

TEST(SharedTimes, StayApartWhereTheScaleIsNotKnownOrContradicted) {
    std::vector<Results> unknown = film_and_md();
    EXPECT_EQ(share_seconds(unknown, std::nullopt), "");
    EXPECT_EQ(unknown[1].source.time_unit, TimeUnit::sqrt_a_over_g);
    std::vector<Results> two = film_and_md();
    two.push_back(run(TimeUnit::second, Origin::video));
    state(two[0], 1);
    state(two[2], 2);
    EXPECT_EQ(share_seconds(two, std::nullopt), "");
    std::vector<Results> alone{run(TimeUnit::sqrt_a_over_g, Origin::md)};
    EXPECT_EQ(share_seconds(alone, 1), "") << "no film beside it";
    EXPECT_EQ(alone[0].source.time_unit, TimeUnit::sqrt_a_over_g);
}

}  // namespace
}  // namespace grainfield::report
