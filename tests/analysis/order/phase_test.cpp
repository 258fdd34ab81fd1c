#include "analysis/order/phase.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield::analysis {
namespace {

TrajectoryInfo seconds() {
    TrajectoryInfo info;
    info.time_unit = TimeUnit::second;
    return info;
}

TEST(PhaseWindow, IsThirtyTwoPeriodsOrFourTenthsOfASecond) {
    EXPECT_DOUBLE_EQ(*PhaseWindow::of({}, seconds()).length, 0.4);
    TrajectoryInfo vibrated = seconds();
    vibrated.vibration_frequency = 80;
    EXPECT_DOUBLE_EQ(*PhaseWindow::of({}, vibrated).length, 0.4);
    EXPECT_FALSE(PhaseWindow::of({}, TrajectoryInfo{}).length.has_value());
    EXPECT_DOUBLE_EQ(*PhaseWindow::of({.window = 2.0}, TrajectoryInfo{}).length, 2);
}

TEST(PhaseHistory, ClassifiesByTheTimeAverageNotByTheFrame) {
    // |Q4| flips between 0.2 and 1: the average 0.6 is neither liquid nor solid.
    PhaseHistory phases({}, seconds(), 8);
    for (int f = 0; f < 8; ++f) {
        const float flip = f % 2 == 0 ? 0.2F : 1.0F;
        phases.add({f, 0.1 * f, {0, 1, 2}, {flip, 0.75F, 0.39F}});
    }
    phases.close_window();
    std::int64_t first = -1;
    EXPECT_EQ(phases.classes(0, first)[0], Phase::between);
    EXPECT_EQ(first, 0);
    EXPECT_EQ(phases.classes(1, first)[1], Phase::solid);
    EXPECT_EQ(phases.classes(2, first)[1], Phase::liquid);
    EXPECT_EQ(phases.classes(1, first).size(), 2U);
    const ObservableResult r = phases.result();
    EXPECT_NEAR(*r.find_measurement("solid_fraction")->value, 1.0 / 3, 1e-12);
    EXPECT_NEAR(*r.find_measurement("liquid_fraction")->value, 1.0 / 3, 1e-12);
    EXPECT_EQ(r.find_curve("phase")->find("frame")->values, (std::vector<double>{0, 4}));
}

// Two particles: one is a liquid, the other looks solid in every fourth frame.
ObservableResult liquid_of(const std::vector<double>& times) {
    PhaseHistory phases({}, seconds(), static_cast<std::int64_t>(times.size()));
    for (std::size_t f = 0; f < times.size(); ++f) {
        phases.add(
            {static_cast<std::int64_t>(f), times[f], {0, 1}, {f % 4 == 0 ? 0.9F : 0.1F, 0.2F}});
    }
    return phases.result();
}

TEST(PhaseHistory, MeanFractionsAndTheirCurveLeaveOutWindowsOfFewFrames) {
    const auto fraction = [](int frames, std::size_t windows) {
        std::vector<double> times;
        for (int f = 0; f < frames; ++f) times.push_back(0.1 * f);  // four a window
        const ObservableResult r = liquid_of(times);
        EXPECT_EQ(r.find_curve("phase")->find("frame")->values.size(), windows);
        return *r.find_measurement("solid_fraction");
    };
    EXPECT_EQ(*fraction(8, 2).value, 0);
    EXPECT_EQ(*fraction(9, 2).value, 0) << "a window of one frame, which looks solid";
    EXPECT_NE(fraction(9, 2).reason.find("windows of few frames left out: 1"), std::string::npos);
    EXPECT_EQ(fraction(10, 3).reason.find("left out"), std::string::npos) << "half of the frames";
    EXPECT_EQ(*fraction(1, 1).value, 0.5) << "the only one there is";
}

TEST(PhaseHistory, TellsShortWindowsByTheirFramesAlsoWhenMerged) {
    PhaseHistory first({}, seconds(), 9), second({}, seconds(), 9);
    for (int f = 0; f < 9; ++f) {
        first.add({f, 0.1 * f, {0}, {0.9F}});
        second.add({f, 1.2 + 0.1 * f, {0}, {0.9F}});
    }
    first.merge(second);
    const WindowRule rule = first.rule();
    const auto is_short = [&](double t) {
        return rule.is_short(first.frames_in(first.window_of(t)));
    };
    EXPECT_FALSE(is_short(0.4));
    EXPECT_TRUE(is_short(0.8));
    EXPECT_FALSE(is_short(1.2));
    EXPECT_TRUE(is_short(2.0));
    EXPECT_EQ(first.frames_in(-1), 0);
    EXPECT_EQ(first.frames_in(99), 0);
}

TEST(PhaseHistory, MeanFractionsAreNotThoseOfOneDenseWindow) {
    PhaseHistory phases({}, seconds(), 60);
    for (int f = 0; f < 20; ++f) phases.add({f, 0.02 * f, {0}, {0.9F}});
    for (int f = 20; f < 60; ++f) phases.add({f, 0.4 + 0.1 * (f - 20), {0}, {0.1F}});
    const ObservableResult r = phases.result();
    EXPECT_NEAR(*r.find_measurement("solid_fraction")->value, 1.0 / 11, 1e-12);
    EXPECT_EQ(r.find_measurement("solid_fraction")->reason.find("left out"), std::string::npos);
}

TEST(PhaseHistory, TakesTimeStampsThatGoBack) {
    PhaseHistory phases({}, seconds(), 3);
    phases.add({0, 5.0, {0}, {0.9F}});
    phases.add({1, 4.1, {0, 1}, {0.2F, 0.9F}});
    phases.add({2, 6.0, {0}, {0.9F}});
    phases.close_window();
    std::int64_t first = -1;
    const auto classes = phases.classes(0, first);
    const auto at = [&](double t) {
        return classes[static_cast<std::size_t>(phases.window_of(t) - first)];
    };
    EXPECT_EQ(at(4.1), Phase::liquid);
    EXPECT_EQ(at(5.0), Phase::solid);
    EXPECT_EQ(at(6.0), Phase::solid);
}

TEST(PhaseHistory, TakesTheThresholdsAsInclusive) {
    PhaseHistory phases({.liquid_below = 0.25, .solid_above = 0.75}, seconds(), 1);
    phases.add({0, 0, {}, {0.25F, 0.75F, 0.5F, std::nanf("")}});
    const ObservableResult r = phases.result();
    EXPECT_NEAR(*r.find_measurement("solid_fraction")->value, 1.0 / 3, 1e-12);
    EXPECT_NEAR(*r.find_measurement("liquid_fraction")->value, 1.0 / 3, 1e-12);
}

TEST(PhaseHistory, SaysWhyFramesStandAlone) {
    PhaseHistory one({}, seconds(), 1);
    one.add({0, 0, {0}, {0.9F}});
    EXPECT_NE(one.result().find_measurement("solid_fraction")->reason.find("one frame"),
              std::string::npos);
    PhaseHistory unlinked({}, seconds(), 2);
    unlinked.add({0, 0, {}, {0.9F}});
    unlinked.add({1, 0.1, {}, {0.1F}});
    const ObservableResult r = unlinked.result();
    EXPECT_NE(r.find_measurement("solid_fraction")->reason.find("not linked"), std::string::npos);
    EXPECT_NEAR(*r.find_measurement("solid_fraction")->value, 0.5, 1e-12);
    PhaseHistory empty({}, seconds(), 2);
    EXPECT_EQ(empty.result().reason, "no frames");
}

TEST(PhaseHistory, DoesNotClassifyParticlesSeenInLessThanHalfOfAWindow) {
    PhaseHistory phases({}, seconds(), 4);
    for (int f = 0; f < 4; ++f) {
        std::vector<std::int64_t> id{0};
        std::vector<float> q{0.9F};
        if (f == 2) {
            id.push_back(5);
            q.push_back(0.1F);
        }
        phases.add({f, 0.1 * f, id, q});
    }
    phases.close_window();
    std::int64_t first = 0;
    EXPECT_EQ(phases.classes(5, first)[0], Phase::unknown);
    EXPECT_NEAR(*phases.result().find_measurement("solid_fraction")->value, 1, 1e-12);
}

TEST(PhaseHistory, MergesAtAWindowBoundary) {
    PhaseHistory whole({}, seconds(), 8), first({}, seconds(), 4), second({}, seconds(), 4);
    for (int f = 0; f < 8; ++f) {
        const PhaseHistory::Sample s{f, 0.1 * f, {3, 4}, {f < 4 ? 0.9F : 0.1F, 0.9F}};
        whole.add(s);
        (f < 4 ? first : second).add(s);
    }
    first.merge(second);
    whole.close_window();
    std::int64_t a = 0, b = 0;
    for (std::int64_t id : {3, 4}) {
        const auto p = whole.classes(id, a);
        const auto q = first.classes(id, b);
        EXPECT_EQ(a, b);
        EXPECT_TRUE(std::equal(p.begin(), p.end(), q.begin(), q.end()));
    }
    EXPECT_EQ(whole.result().find_measurement("solid_fraction")->value,
              first.result().find_measurement("solid_fraction")->value);
}

TEST(PhaseHistory, RefusesCrossedThresholds) {
    EXPECT_THROW(PhaseHistory({.liquid_below = 0.8, .solid_above = 0.7}, seconds(), 2),
                 OptionError);
}

TEST(PhaseHistory, TakesATinyAveragingTimeWithoutMemoryPerElapsedWindow) {
    // 1e12 windows pass between two frames: only those that hold a frame may exist.
    PhaseHistory phases({.window = 1e-12}, seconds(), 4);
    for (int f = 0; f < 4; ++f) phases.add({f, 1.0 * f, {0, 1}, {f < 2 ? 0.9F : 0.1F, 0.9F}});
    phases.close_window();
    std::int64_t first = -1;
    const auto classes = phases.classes(0, first);
    ASSERT_EQ(classes.size(), 4U);
    for (int f = 0; f < 4; ++f) {
        const auto at = static_cast<std::size_t>(phases.window_of(1.0 * f) - first);
        EXPECT_EQ(classes[at], f < 2 ? Phase::solid : Phase::liquid);
    }
    EXPECT_EQ(phases.window_of(0.5), -1);
    const ObservableResult r = phases.result();
    EXPECT_EQ(r.find_measurement("solid_fraction")->reason,
              "no window of 1e-12 holds two frames: phase of one frame");
    EXPECT_NE(r.find_measurement("averaging_time")->reason.find("1 frames in it"),
              std::string::npos);
}

TEST(PhaseHistory, KeepsFramesApartWhoseWindowsHaveNoNumber) {
    PhaseHistory phases({.window = 1e-300}, seconds(), 3);
    for (int f = 0; f < 3; ++f) phases.add({f, 1e10 + f, {0}, {0.9F}});
    EXPECT_EQ(phases.result().find_curve("phase")->find("frame")->values.size(), 3U);
}

TEST(PhaseHistory, GivesTheTimeOfEachWindow) {
    PhaseHistory phases({}, seconds(), 8);
    for (int f = 0; f < 8; ++f) phases.add({f, 0.1 * f, {0}, {0.9F}});
    const ObservableResult r = phases.result();
    const auto& t = r.find_curve("phase")->find("t")->values;
    ASSERT_EQ(t.size(), 2U);
    EXPECT_DOUBLE_EQ(t[0], 0);
    EXPECT_DOUBLE_EQ(t[1], 0.4);
    EXPECT_EQ(r.find_measurement("solid_fraction")->reason,
              "the same in every frame: no error from fluctuations");
}

}  // namespace
}  // namespace grainfield::analysis
