#include "analysis/spectra/listed_modes.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "analysis/spectra/structure_factor.h"
#include "core/errors.h"
#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

const std::vector<double>& column(const ObservableResult& r, const char* curve, const char* name) {
    return r.find_curve(curve)->find(name)->values;
}

TEST(ListedModes, OnTheGridAreThoseOfTheFullMap) {
    RandomStream random(1, "grid");
    for (const Boundary boundary : {Boundary::periodic, Boundary::walls}) {
        const Box box{{3, -7}, {20, 14}, {boundary, boundary}, 0};
        for (const int frames : {1, 5, 40}) {
            StructureFactor sk({}, box, frames);
            std::vector<Vec2> k;
            for (const Mode& mode : sk.grid().modes()) {
                k.push_back({mode.nx * sk.grid().spacing().x, mode.ny * sk.grid().spacing().y});
            }
            ListedModes listed(k, box, frames);
            for (int f = 0; f < frames; ++f) {
                const Pattern p = pattern(poisson_points(300, box, random), box, f);
                sk.add(sk.measure(p));
                listed.add(listed.measure(p));
            }
            ObservableResult r = sk.result();
            listed.add_to(r);
            const auto& s = column(r, "sk_list", "s_raw");
            double mean = 0;
            for (std::size_t m = 0; m < s.size(); ++m) mean += s[m] / static_cast<double>(s.size());
            double map = 0;
            double modes = 0;
            for (std::size_t i = 0; i < column(r, "sk_raw", "k").size(); ++i) {
                map += column(r, "sk_raw", "s")[i] * column(r, "sk_raw", "n")[i];
                modes += column(r, "sk_raw", "n")[i];
            }
            EXPECT_EQ(modes, static_cast<double>(k.size()));
            EXPECT_NEAR(mean, map / modes, 1e-10);
            if (boundary == Boundary::periodic || frames == 1) {
                EXPECT_EQ(column(r, "sk_list", "s"), s);
                const auto& of_map = column(r, "sk_map", "s");
                ASSERT_EQ(of_map.size(), s.size());
                for (std::size_t m = 0; m < s.size(); ++m) EXPECT_NEAR(of_map[m], s[m], 1e-9);
            }
        }
    }
}

TEST(ListedModes, OfVectorsBetweenTheModesAreTheSumOverPairs) {
    RandomStream random(2, "pairs");
    const Box box = square_box(9);
    const Pattern p = pattern(poisson_points(40, box, random), box);
    const std::vector<Vec2> k{{0, 0}, {0.3, -0.71}, {12.5, 1e-3}, {-0.3, 0.71}};
    ListedModes listed(k, box, 1);
    listed.add(listed.measure(p));
    ObservableResult r;
    listed.add_to(r);
    for (std::size_t m = 0; m < k.size(); ++m) {
        double sum = 0;
        for (const Vec2& a : p.position) {
            for (const Vec2& b : p.position) sum += std::cos(dot(k[m], a - b));
        }
        EXPECT_NEAR(column(r, "sk_list", "s")[m], sum / 40, 1e-11);
        EXPECT_EQ(column(r, "sk_list", "kx")[m], k[m].x);
    }
    EXPECT_NEAR(column(r, "sk_list", "s")[0], 40, 1e-12);
    EXPECT_NEAR(column(r, "sk_list", "s")[1], column(r, "sk_list", "s")[3], 1e-11);
}

// Independent Poisson frames of a fixed number between walls: connected S = 1 − |p̂(k)|². The mean
// over 40 vectors and the errors that are stated: with 64 frames S of one vector is a mean of 63
// exponentially distributed numbers, relative error 0.126, of 40 independent ones 0.02; 6 of them:
// p < 1e-8.
TEST(ListedModes, OfIndependentPointsBetweenWallsIsOneLessTheShapeOfTheBox) {
    RandomStream random(3, "walls");
    const Box box = square_box(20, Boundary::walls);
    std::vector<Vec2> k;
    for (int m = 0; m < 40; ++m) k.push_back({0.33 + 0.5 * (m % 8), 0.4 + 0.5 * (m / 8)});
    ListedModes first(k, box, 32), second(k, box, 32), whole(k, box, 64);
    for (int f = 0; f < 64; ++f) {
        const auto sample = whole.measure(pattern(poisson_points(200, box, random), box, f));
        whole.add(sample);
        (f < 32 ? first : second).add(sample);
    }
    ObservableResult r, merged;
    whole.add_to(r);
    first.merge(second);
    first.add_to(merged);
    double mean = 0;
    double pull2 = 0;
    for (std::size_t m = 0; m < k.size(); ++m) {
        const auto shape = [](double q) { return std::pow(std::sin(10 * q) / (10 * q), 2); };
        const double wanted = 1 - shape(k[m].x) * shape(k[m].y);
        const double s = column(r, "sk_list", "s")[m];
        const double error = column(r, "sk_list", "s_err")[m];
        mean += s / wanted / 40;
        pull2 += std::pow((s - wanted) / error, 2) / 40;
        EXPECT_NEAR(column(merged, "sk_list", "s_raw")[m], column(r, "sk_list", "s_raw")[m], 1e-9);
    }
    EXPECT_NEAR(mean, 1, 0.12);
    // 16 blocks know their error to a fifth: the mean square of 40 pulls is 1 ± 0.35.
    EXPECT_NEAR(pull2, 1, 0.95);
}

TEST(ListedModes, SayNothingWithoutParticlesAndRefuseWhatIsNoNumber) {
    const Box box = square_box(5);
    ListedModes listed({{1, 2}}, box, 1);
    ObservableResult r;
    listed.add_to(r);
    listed.add(listed.measure(pattern({}, box)));
    listed.add_to(r);
    EXPECT_TRUE(r.curves.empty());
    EXPECT_THROW(ListedModes({{1, std::numeric_limits<double>::quiet_NaN()}}, box, 1), OptionError);
}

TEST(StructureFactor, OnAnnuliIsTheMeanOfTheModesInThem) {
    RandomStream random(4, "annuli");
    const Box box = square_box(20);
    StructureFactorOptions options;
    options.edges = {0.5, 0.9, 1.0, 1.7};
    StructureFactor annuli(options, box, 3), all({}, box, 3);
    for (int f = 0; f < 3; ++f) {
        const Pattern p = pattern(poisson_points(300, box, random), box, f);
        annuli.add(annuli.measure(p));
        all.add(all.measure(p));
    }
    const ObservableResult r = annuli.result();
    const ObservableResult map = all.result();
    const std::vector<double> edges{0.5, 0.9, 1.0, 1.7};
    ASSERT_EQ(column(r, "sk", "k").size(), 3U);
    for (std::size_t a = 0; a < 3; ++a) {
        double s = 0, k = 0, n = 0;
        for (std::size_t m = 0; m < column(map, "sk_map", "s").size(); ++m) {
            const double q =
                std::hypot(column(map, "sk_map", "kx")[m], column(map, "sk_map", "ky")[m]);
            if (q < edges[a] || q >= edges[a + 1]) continue;
            s += column(map, "sk_map", "s")[m];
            k += q;
            n += 1;
        }
        EXPECT_EQ(column(r, "sk", "n")[a], n);
        EXPECT_NEAR(column(r, "sk", "s")[a], s / n, 1e-12);
        EXPECT_NEAR(column(r, "sk", "k")[a], k / n, 1e-12);
    }
}

// A wave that goes once through a run has an S and no error; one that is new in every frame has
// one.
TEST(ListedModes, GiveNoErrorToWhatChangesMoreSlowlyThanTheRunIsLong) {
    const Box box = square_box(20);
    const std::vector<Vec2> k{{2 * std::numbers::pi / 20, 0}};
    RandomStream random(6, "drift");
    ListedModes slow(k, box, 64);
    ListedModes fast(k, box, 64);
    const std::vector<Vec2> start = poisson_points(100, box, random);
    for (int f = 0; f < 64; ++f) {
        std::vector<Vec2> moved = start;
        for (Vec2& p : moved) p.x = std::fmod(p.x + 20.0 * f / 64, 20.0);
        slow.add(slow.measure(pattern(moved, box, f)));
        fast.add(fast.measure(pattern(poisson_points(100, box, random), box, f)));
    }
    ObservableResult of_slow;
    ObservableResult of_fast;
    slow.add_to(of_slow);
    fast.add_to(of_fast);
    EXPECT_TRUE(std::isnan(of_slow.find_curve("sk_list")->find("s_err")->values[0]));
    EXPECT_GT(of_fast.find_curve("sk_list")->find("s_err")->values[0], 0);
}

TEST(StructureFactor, RefusesEdgesThatDoNotAscendAndSaysWhereNoModeLies) {
    const Box box = square_box(20);
    StructureFactorOptions options;
    for (const char* edges : {"1", "a,b", "1,,2", "-1,2", "1;2", "0.1,nan"}) {
        EXPECT_THROW(describe(options).set("edges", std::string(edges)), OptionError) << edges;
    }
    for (const std::vector<double>& edges :
         std::vector<std::vector<double>>{{1}, {1, 0.5}, {1, 1}, {-1, 2}, {0.1, std::nan("")}}) {
        options.edges = edges;
        EXPECT_THROW(StructureFactor(options, box, 1), OptionError) << edges.size();
    }
    options.edges = {0.01, 0.02};
    StructureFactor sk(options, box, 1);
    RandomStream random(5, "none");
    sk.add(sk.measure(pattern(poisson_points(30, box, random), box)));
    EXPECT_NE(sk.result().reason.find("annuli 0.01,0.02"), std::string::npos);
}

}  // namespace
}  // namespace grainfield::analysis
