#include "analysis/motion/displacement.h"

#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

// t → msd of one phase.
std::map<double, double> series(const ObservableResult& r, const std::string& phase,
                                const char* name = "msd") {
    const Curve* curve = r.find_curve("msd");
    std::map<double, double> values;
    if (curve == nullptr) return values;
    for (std::size_t i = 0; i < curve->find("t")->values.size(); ++i) {
        if (curve->text_columns.at("phase")[i] == phase) {
            values[curve->find("t")->values[i]] = curve->find(name)->values[i];
        }
    }
    return values;
}

Pattern linked(std::vector<Vec2> points, std::vector<std::int64_t> id, const Box& box,
               std::int64_t frame) {
    Pattern p = pattern(std::move(points), box, frame);
    p.id = std::move(id);
    return p;
}

constexpr DisplacementOptions all_lags{.lags = LagSpacing::all};

TEST(Displacement, OfBallisticParticlesGrowsAsTimeSquaredThroughPeriodicBoundaries) {
    const Box box = square_box(10);
    Displacement msd(all_lags, 40);
    for (int f = 0; f < 40; ++f) {
        std::vector<Vec2> points;
        for (int i = 0; i < 20; ++i) points.push_back({0.5 * i + 3 * 0.25 * f, 1 + 4 * 0.25 * f});
        msd.add(linked(points, identities(20), box, f));
    }
    const ObservableResult r = msd.result();
    for (const auto& [t, value] : series(r, "all")) {
        EXPECT_NEAR(value, 25 * 0.0625 * t * t, 1e-11 * t * t);
    }
    EXPECT_NEAR(*r.find_measurement("exponent_all")->value, 2, 1e-9);
}

TEST(Displacement, CountsOnlyPairsThatWereSeenWhenTracksHaveGaps) {
    RandomStream random(1, "gaps");
    const Box box = square_box(100, Boundary::walls);
    const int frames = 30;
    const int particles = 12;
    std::vector<std::vector<Vec2>> path(particles);
    std::vector<std::vector<bool>> seen(particles);
    for (auto i = 0U; i < particles; ++i) {
        for (int f = 0; f < frames; ++f) {
            path[i].push_back({50 + random.normal(), 50 + random.normal()});
            seen[i].push_back(random.uniform() < 0.7);
        }
    }
    // Frames 11 and 12 are missing altogether.
    Displacement msd(all_lags, frames - 2);
    for (int f = 0; f < frames; ++f) {
        if (f == 11 || f == 12) continue;
        std::vector<Vec2> points;
        std::vector<std::int64_t> id;
        for (auto i = 0U; i < particles; ++i) {
            if (!seen[i][static_cast<std::size_t>(f)]) continue;
            points.push_back(path[i][static_cast<std::size_t>(f)]);
            id.push_back(i);
        }
        msd.add(linked(points, id, box, f));
    }
    const ObservableResult r = msd.result();
    const auto value = series(r, "all");
    const auto pairs = series(r, "all", "n");
    ASSERT_GE(value.size(), 14U);
    for (const auto& [t, found] : value) {
        const auto lag = static_cast<std::size_t>(t);
        double sum = 0;
        double count = 0;
        for (auto i = 0U; i < particles; ++i) {
            for (std::size_t f = 0; f + lag < frames; ++f) {
                const auto there = [&](std::size_t g) { return seen[i][g] && g != 11 && g != 12; };
                if (!there(f) || !there(f + lag)) continue;
                sum += squared_norm(path[i][f + lag] - path[i][f]);
                count += 1;
            }
        }
        EXPECT_EQ(pairs.at(t), count);
        EXPECT_NEAR(found, sum / count, 1e-12 * found);
    }
}

TEST(Displacement, SplitsByThePhaseAtTheStart) {
    // Particle 0 is liquid and moves 1 a frame, particle 1 is solid and rests.
    const Box box = square_box(1000, Boundary::walls);
    TrajectoryInfo info;
    info.time_unit = TimeUnit::second;
    PhaseHistory phases({.window = 4.0}, info, 40);
    Displacement msd(all_lags, 40);
    for (int f = 0; f < 40; ++f) {
        phases.add({f, static_cast<double>(f), {0, 1}, {0.1F, 0.9F}});
        msd.add(linked({{10.0 + f, 5}, {500, 500}}, {0, 1}, box, f));
    }
    phases.close_window();
    const ObservableResult r = msd.result(&phases);
    for (const auto& [t, value] : series(r, "liquid")) EXPECT_NEAR(value, t * t, 1e-12 * t * t);
    for (const auto& [t, value] : series(r, "solid")) EXPECT_EQ(value, 0);
    for (const auto& [t, value] : series(r, "all")) EXPECT_NEAR(value, t * t / 2, 1e-12 * t * t);
}

TEST(Displacement, TakesNoPhaseFromAWindowOfFewFrames) {
    // As above, but with a window of one frame, in which the liquid particle looks solid.
    const Box box = square_box(1000, Boundary::walls);
    TrajectoryInfo info;
    info.time_unit = TimeUnit::second;
    PhaseHistory phases({.window = 4.0}, info, 17);
    Displacement msd(all_lags, 17);
    for (int f = 0; f < 20; ++f) {
        if (f > 8 && f < 12) continue;
        phases.add({f, static_cast<double>(f), {0, 1}, {f == 8 ? 0.9F : 0.1F, 0.9F}});
        msd.add(linked({{10.0 + f, 5}, {500, 500}}, {0, 1}, box, f));
    }
    phases.close_window();
    const ObservableResult r = msd.result(&phases);
    for (const auto& [t, value] : series(r, "solid")) EXPECT_EQ(value, 0) << t;
    for (const auto& [t, value] : series(r, "liquid")) EXPECT_NEAR(value, t * t, 1e-12 * t * t);
}

TEST(Displacement, UsesTheTimeStampsAndTheStrideOfTheFrames) {
    const Box box = square_box(1000, Boundary::walls);
    Displacement msd(all_lags, 20);
    for (int f = 0; f < 20; ++f) {
        Pattern p = linked({{0.1 * f, 0}}, {0}, box, 10 * f);
        p.time = 0.02 * f;
        msd.add(std::move(p));
    }
    const auto values = series(msd.result(), "all");
    ASSERT_EQ(values.size(), 9U);
    EXPECT_NEAR(values.begin()->first, 0.02, 1e-12);
    EXPECT_NEAR(values.begin()->second, 0.01, 1e-12);
}

TEST(Displacement, OfACagedGrainFarAwayKeepsItsDigits) {
    // Steps of 2^-20 a at 2^20 a: exact in double, lost in single precision.
    const double far = 1048576;
    const double step = 1 / far;
    const Box box = square_box(10, Boundary::walls, {far, far});
    Displacement msd(all_lags, 20);
    for (int f = 0; f < 20; ++f) {
        msd.add(linked({{far + 5 + (f % 2) * step, far + 5}}, {0}, box, f));
    }
    const auto values = series(msd.result(), "all");
    EXPECT_DOUBLE_EQ(values.at(1), step * step);
    EXPECT_DOUBLE_EQ(values.at(2), 0);
}

TEST(Displacement, IsBoundedInMemoryByLeavingOutParticles) {
    RandomStream random(2, "memory");
    const Box box = square_box(1000, Boundary::walls);
    Displacement msd({.memory_mb = 1}, 100);
    for (int f = 0; f < 100; ++f) {
        std::vector<Vec2> points;
        for (int i = 0; i < 5000; ++i) points.push_back({0.1 * f, 0.1 * i});
        msd.add(linked(points, identities(5000), box, f));
    }
    const ObservableResult r = msd.result();
    EXPECT_NE(r.find_measurement("d_all")->reason.find("kept"), std::string::npos);
    for (const auto& [t, value] : series(r, "all")) EXPECT_NEAR(value, 0.01 * t * t, 1e-9);
    EXPECT_LT(series(r, "all", "n").at(1), 1e6 / 16 * 1.01);
}

TEST(Displacement, OfTwoMergedHalvesIsThatOfTheWhole) {
    RandomStream random(3, "merge");
    const Box box = square_box(10);
    Displacement whole(all_lags, 20), first(all_lags, 10), second(all_lags, 10);
    std::vector<Vec2> points = poisson_points(30, box, random);
    for (int f = 0; f < 20; ++f) {
        for (Vec2& p : points) p = box.wrap(p + Vec2{random.normal(), random.normal()});
        std::vector<std::int64_t> id = identities(30);
        std::vector<Vec2> here = points;
        if (f == 10) {  // unseen at the seam
            id.erase(id.begin());
            here.erase(here.begin());
        }
        const Pattern p = linked(here, id, box, f);
        whole.add(p);
        (f < 10 ? first : second).add(p);
    }
    first.merge(second);
    const auto a = series(whole.result(), "all");
    const auto b = series(first.result(), "all");
    ASSERT_EQ(a.size(), b.size());
    for (const auto& [t, value] : a) EXPECT_NEAR(b.at(t), value, 1e-11 * value);
}

TEST(Displacement, GivesReasonsWhereItCannotBeMeasured) {
    const Box box = square_box(10);
    Displacement none({}, 0);
    EXPECT_EQ(none.result().reason, "no frames");
    none.add(linked({{1, 1}}, {0}, box, 0));
    EXPECT_NE(none.result().reason.find("one frame"), std::string::npos);
    none.add(pattern({{1, 1}}, box, 1));
    EXPECT_NE(none.result().reason.find("not linked"), std::string::npos);
    Displacement strangers({}, 2);
    strangers.add(linked({{1, 1}}, {0}, box, 0));
    strangers.add(linked({{1, 1}}, {1}, box, 1));
    EXPECT_NE(strangers.result().reason.find("two frames"), std::string::npos);
    Displacement backwards({}, 2);
    backwards.add(linked({{1, 1}}, {0}, box, 5));
    backwards.add(linked({{1, 1}}, {0}, box, 4));
    EXPECT_FALSE(backwards.result().reason.empty());
}

TEST(Displacement, OfTwoFramesHasOneLagAndNoFit) {
    const Box box = square_box(10);
    Displacement msd({}, 2);
    msd.add(linked({{1, 1}}, {0}, box, 0));
    msd.add(linked({{1, 2}}, {0}, box, 1));
    const ObservableResult r = msd.result();
    EXPECT_EQ(series(r, "all").at(1), 1);
    EXPECT_FALSE(r.find_measurement("d_all")->value.has_value());
    EXPECT_FALSE(r.find_measurement("d_all")->reason.empty());
}

TEST(Displacement, PoolsPairsByTheirTimeStampsNotByFrameNumbers) {
    // Consecutive frame numbers, 1 apart in time for the first half, 2 for the second, drifting at
    // speed 1: MSD = t² exactly if lags are times.
    const Box box = square_box(1000, Boundary::walls);
    Displacement msd(all_lags, 40);
    for (int f = 0; f < 40; ++f) {
        const double t = f < 20 ? f : 20 + 2 * (f - 20);
        Pattern p = linked({{10 + t, 5}, {10 + t, 50}}, {0, 1}, box, f);
        p.time = t;
        msd.add(std::move(p));
    }
    const auto values = series(msd.result(), "all");
    ASSERT_GE(values.size(), 20U);
    for (const auto& [t, value] : values) EXPECT_NEAR(value, t * t, 1e-12 * t * t);
    EXPECT_EQ(series(msd.result(), "all", "n").at(1), 2 * 20);
}

TEST(Displacement, TakesTimeStampsWithJitterAsOneInterval) {
    RandomStream random(31, "jitter");
    const Box box = square_box(1000, Boundary::walls);
    Displacement msd(all_lags, 60);
    for (int f = 0; f < 60; ++f) {
        Pattern p = linked({{10.0 + f, 5}}, {0}, box, f);
        p.time = 0.04 * f + 0.001 * random.uniform();
        msd.add(std::move(p));
    }
    const ObservableResult r = msd.result();
    const auto pairs = series(r, "all", "n");
    EXPECT_EQ(pairs.begin()->second, 59);
    EXPECT_NEAR(pairs.begin()->first, 0.04, 0.001);
}

TEST(Displacement, SaysInWhatStepsUnevenTimeStampsWereGrouped) {
    const Box box = square_box(1000, Boundary::walls);
    Displacement msd(all_lags, 40);
    Displacement hopeless(all_lags, 40);
    for (int f = 0; f < 40; ++f) {
        Pattern p = linked({{10.0 + f, 5}}, {0}, box, f);
        p.time = f + (f % 2) * 0.5;
        msd.add(p);
        p.time = std::pow(1.37, f);
        hopeless.add(std::move(p));
    }
    EXPECT_NE(msd.result().find_measurement("d_all")->reason.find("uneven time stamps"),
              std::string::npos);
    EXPECT_NE(hopeless.result().reason.find("too unevenly"), std::string::npos);
}

TEST(Displacement, TakesTimeStampsThatGoBack) {
    const Box box = square_box(1000, Boundary::walls);
    Displacement msd(all_lags, 20);
    for (int f = 0; f < 20; ++f) {
        const int t = f == 7 ? 8 : f == 8 ? 7 : f;  // two frames swapped
        Pattern p = linked({{10.0 + t, 5}}, {0}, box, f);
        p.time = t;
        msd.add(std::move(p));
    }
    for (const auto& [t, value] : series(msd.result(), "all")) EXPECT_NEAR(value, t * t, 1e-9);
}

TEST(Displacement, CountsParticlesAsItsIndependentSamples) {
    RandomStream random(32, "samples");
    const Box box = square_box(1000, Boundary::walls);
    Displacement msd(all_lags, 50);
    std::vector<Vec2> points(40, Vec2{500, 500});
    for (int f = 0; f < 50; ++f) {
        for (Vec2& p : points) p += Vec2{random.normal(), random.normal()};
        msd.add(linked(points, identities(40), box, f));
    }
    EXPECT_EQ(msd.result().find_measurement("d_all")->samples, 40);
}

}  // namespace
}  // namespace grainfield::analysis
