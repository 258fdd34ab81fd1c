#include "analysis/spectra/structure_factor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/statistics/blocks.h"
#include "core/errors.h"
#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

const std::vector<double>& column(const ObservableResult& r, const char* curve, const char* name) {
    return r.find_curve(curve)->find(name)->values;
}

TEST(StructureFactor, WithOneWalledFrameIsRawAndSaysSo) {
    RandomStream random(1, "one");
    const Box box = square_box(30, Boundary::walls);
    StructureFactor sk({}, box, 1);
    sk.add(sk.measure(pattern(poisson_points(900, box, random), box)));
    const ObservableResult r = sk.result();
    EXPECT_EQ(column(r, "sk", "s"), column(r, "sk_raw", "s"));
    EXPECT_NE(r.find_measurement("s_lowest_k")->reason.find("one frame"), std::string::npos);
    EXPECT_EQ(r.find_curve("sk_neumann"), nullptr);
}

TEST(StructureFactor, OfAPeriodicBoxIsTheRawOneOnTheFullGrid) {
    RandomStream random(2, "periodic");
    const Box box = square_box(30);
    StructureFactor sk({}, box, 2);
    for (int f = 0; f < 2; ++f) sk.add(sk.measure(pattern(poisson_points(900, box, random), box)));
    const ObservableResult r = sk.result();
    EXPECT_EQ(column(r, "sk", "s"), column(r, "sk_raw", "s"));
    EXPECT_NEAR(column(r, "sk", "k").front(), 2 * std::numbers::pi / 30, 1e-12);
}

// Points that move slowly, and the lowest mode alone: 16 blocks of two frames.
TEST(StructureFactor, AddsTheVarianceOfTheMeanThatItSubtracts) {
    constexpr int frames = 32;
    constexpr int blocks = 16;
    constexpr double length = 10;
    const Box box = square_box(length, Boundary::walls);
    RandomStream random(11, "slow");
    std::vector<Vec2> points = poisson_points(200, box, random);
    StructureFactor sk({.k_max = 0.5}, box, frames);
    std::vector<double> c;
    for (int f = 0; f < frames; ++f) {
        sk.add(sk.measure(pattern(points, box, f)));
        double sum = 0;
        for (Vec2& p : points) {
            const double q = std::numbers::pi / length;
            sum += std::cos(q * p.x) * std::cos(q * p.y);
            for (double* x : {&p.x, &p.y}) {
                *x = std::clamp(*x + 0.8 * random.normal(), 0.0, length * (1 - 1e-9));
            }
        }
        c.push_back(sum);
    }
    double mean = 0, square = 0;
    for (const double x : c) {
        mean += x / frames;
        square += x * x / frames;
    }
    std::vector<double> means;
    for (std::size_t b = 0; b < blocks; ++b) means.push_back(0.5 * (c[2 * b] + c[2 * b + 1]));
    BlockScatter scatter;
    add_scatter<double>(scatter, std::vector<double>(blocks, 2.0), means);
    const double variance = square - mean * mean;
    const BlockDrift drift = block_drift(scatter, blocks);
    ASSERT_GT(drift.excess, 1.2);  // else this test would hold with independent blocks, too
    const double independent = std::clamp(blocks * variance / (scatter.squares / (blocks - 1)),
                                          1.0 * blocks, 1.0 * frames);
    const double left = frames_of_mean(independent, drift);
    const ObservableResult result = sk.result();
    ASSERT_EQ(column(result, "sk_neumann", "k").size(), 1U);
    EXPECT_NEAR(column(result, "sk_neumann", "s")[0], 4 * variance / 200 * left / (left - 1), 1e-9);
}

TEST(StructureFactor, TakesOutAnyStaticProfileExactly) {
    // Frames that repeat one pattern: nothing fluctuates, so the connected S is 0.
    RandomStream random(3, "static");
    const Box box = square_box(30, Boundary::walls);
    const Pattern p = pattern(poisson_points(900, box, random), box);
    StructureFactor sk({}, box, 20);
    for (int f = 0; f < 20; ++f) sk.add(sk.measure(p));
    const ObservableResult r = sk.result();
    for (double s : column(r, "sk", "s")) EXPECT_NEAR(s, 0, 1e-12);
    for (double s : column(r, "sk_raw", "s")) EXPECT_GT(s, 0.05);
    for (double s : column(r, "sk_neumann", "s")) EXPECT_NEAR(s, 0, 1e-12);
}

TEST(StructureFactor, OfTwoMergedHalvesIsThatOfTheWhole) {
    RandomStream random(4, "merge");
    const Box box = square_box(20, Boundary::walls);
    StructureFactor whole({}, box, 10), first({}, box, 5), second({}, box, 5);
    for (int f = 0; f < 10; ++f) {
        const auto sample = whole.measure(pattern(poisson_points(400, box, random), box, f));
        whole.add(sample);
        (f < 5 ? first : second).add(sample);
    }
    first.merge(second);
    for (const char* curve : {"sk", "sk_raw", "sk_neumann"}) {
        const auto a = column(whole.result(), curve, "s");
        const auto b = column(first.result(), curve, "s");
        const auto ea = column(whole.result(), curve, "s_err");
        const auto eb = column(first.result(), curve, "s_err");
        for (std::size_t i = 0; i < a.size(); ++i) {
            EXPECT_NEAR(a[i], b[i], 1e-12 * a[i]);
            EXPECT_NEAR(ea[i], eb[i], 1e-9 * a[i]);
        }
    }
}

TEST(StructureFactor, IsTheSameUnderTranslationQuarterTurnAndReordering) {
    RandomStream random(5, "symmetry");
    const Box box = square_box(20);
    const std::vector<Vec2> points = poisson_points(400, box, random);
    const auto s_of = [&](const std::vector<Vec2>& p) {
        StructureFactor sk({}, box, 1);
        sk.add(sk.measure(pattern(p, box)));
        return column(sk.result(), "sk", "s");
    };
    std::vector<Vec2> moved, turned, reversed(points.rbegin(), points.rend());
    for (Vec2 p : points) {
        moved.push_back(p + Vec2{2.2, 13.7});
        turned.push_back({-p.y, p.x});
    }
    const auto s = s_of(points);
    for (const auto& other : {s_of(moved), s_of(turned), s_of(reversed)}) {
        for (std::size_t i = 0; i < s.size(); ++i) EXPECT_NEAR(other[i], s[i], 1e-10);
    }
}

TEST(StructureFactor, EstimatesFewerIndependentFramesFromRepeatedOnes) {
    // Each pattern shown 8 times in a row: 64 frames hold 8 independent ones. The estimate is
    // bounded below by the 16 blocks, so it must come out far below 64.
    RandomStream random(6, "repeat");
    const Box box = square_box(20, Boundary::walls);
    StructureFactor sk({}, box, 512);
    StructureFactor independent({}, box, 512);
    Pattern p;
    for (int f = 0; f < 512; ++f) {
        if (f % 8 == 0) p = pattern(poisson_points(400, box, random), box, f);
        sk.add(sk.measure(p));
        independent.add(independent.measure(pattern(poisson_points(400, box, random), box, f)));
    }
    const auto repeated = column(sk.result(), "sk_samples", "samples");
    const auto all = column(independent.result(), "sk_samples", "samples");
    // Shells of many modes: the estimate has a relative error of about sqrt(2 / (15 · modes)).
    EXPECT_NEAR(repeated.back(), 64, 10);
    EXPECT_GT(all.back(), 440);
}

TEST(StructureFactor, HoldsUnequalNumbersOfParticlesAgainstTheMeanNumber) {
    const Box box = square_box(10);
    StructureFactor sk({.k_max = 1.5}, box, 2);
    RandomStream random(7, "unequal");
    const Pattern a = pattern(poisson_points(50, box, random), box);
    const Pattern b = pattern(poisson_points(150, box, random), box);
    const auto sa = sk.measure(a);
    const auto sb = sk.measure(b);
    sk.add(sa);
    sk.add(sb);
    double power = 0;
    double modes = 0;
    for (std::size_t m = 0; m < sk.grid().modes().size(); ++m) {
        if (sk.grid().modes()[m].k > 1.01 * sk.grid().spacing().x) continue;
        power += std::norm(sa.rho[m]) + std::norm(sb.rho[m]);
        modes += 1;
    }
    EXPECT_NEAR(column(sk.result(), "sk", "s").front(), power / modes / 2 / 100, 1e-12);
}

TEST(StructureFactor, GivesReasonsWhereThereIsNothingToMeasure) {
    const Box box = square_box(10);
    EXPECT_EQ(StructureFactor({}, box, 0).result().reason, "no frames");
    StructureFactor empty({}, box, 1);
    empty.add(empty.measure(pattern({}, box)));
    EXPECT_EQ(empty.result().reason, "no particles");
    StructureFactor small({.k_max = 0.1}, box, 1);
    small.add(small.measure(pattern({{1, 1}}, box)));
    EXPECT_NE(small.result().reason.find("no wavevector"), std::string::npos);
}

TEST(StructureFactor, RefusesABoxThatChanges) {
    StructureFactor sk({}, square_box(10), 2);
    EXPECT_THROW(sk.measure(pattern({{1, 1}}, square_box(11))), InputError);
}

TEST(StructureFactor, RefusesWavevectorsThatWouldNotFitIntoTheMemory) {
    // 2.5e7 modes: below the bound of the grid, but 22 GB in 16 blocks.
    try {
        const StructureFactor sk({.k_max = 25}, square_box(1000), 100);
        FAIL() << "accepted";
    } catch (const OptionError& error) {
        EXPECT_NE(std::string(error.what()).find("sk.k-max"), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("GB"), std::string::npos) << error.what();
    }
}

TEST(StructureFactor, SaysInItsTitleThatOneWalledFrameHasTheWallsInIt) {
    RandomStream random(8, "title");
    const Box box = square_box(30, Boundary::walls);
    StructureFactor sk({}, box, 1);
    sk.add(sk.measure(pattern(poisson_points(900, box, random), box)));
    EXPECT_NE(sk.result().find_curve("sk")->title.find("walls"), std::string::npos);
}

TEST(StructureFactor, OfFewerThanFourFramesSaysThatItTakesThemAsIndependent) {
    RandomStream random(9, "few");
    const Box box = square_box(30, Boundary::walls);
    StructureFactor sk({}, box, 3);
    for (int f = 0; f < 3; ++f)
        sk.add(sk.measure(pattern(poisson_points(900, box, random), box, f)));
    EXPECT_FALSE(sk.result().find_measurement("s_lowest_k")->reason.empty());
}

// Particles that have moved by half a diameter at the end: the modes at small k are those of the
// first frame.
TEST(StructureFactor, OfAFilmTooShortForItsModesHasNoErrorAtSmallK) {
    for (const Boundary boundary : {Boundary::periodic, Boundary::walls}) {
        RandomStream random(10, "slow");
        const Box box = square_box(60, boundary);
        const std::vector<Vec2> first = poisson_points(2000, box, random);
        std::vector<Vec2> velocity;
        for (std::size_t j = 0; j < first.size(); ++j) {
            velocity.push_back({random.normal(), random.normal()});
        }
        constexpr int frames = 64;
        StructureFactor sk({}, box, frames);
        for (int f = 0; f < frames; ++f) {
            std::vector<Vec2> now;
            for (std::size_t j = 0; j < first.size(); ++j) {
                now.push_back(first[j] + velocity[j] * (0.5 * f / frames));
            }
            sk.add(sk.measure(pattern(now, box, f)));
        }
        const ObservableResult result = sk.result();
        EXPECT_TRUE(std::isnan(column(result, "sk", "s_err").front()));
        const Measurement* m = result.find_measurement("s_lowest_k");
        EXPECT_TRUE(m->value.has_value());
        EXPECT_FALSE(m->error.has_value());
        EXPECT_NE(m->reason.find("slowly"), std::string::npos) << m->reason;
    }
}

// Of a run that was cut short most blocks are empty: they are no copies of one estimate.
TEST(StructureFactor, BlocksThatNoFrameCameToGiveNoError) {
    RandomStream random(11, "cut");
    const Box box = square_box(30);
    StructureFactor sk({}, box, 1600);
    for (int f = 0; f < 150; ++f) {
        sk.add(sk.measure(pattern(poisson_points(300, box, random), box, f)));
    }
    EXPECT_TRUE(std::isnan(column(sk.result(), "sk", "s_err").front()));
}

// Ten frames alike, then ten others: whether the run was to be twice as long does not make them
// independent.
TEST(StructureFactor, FramesOfARunThatWasCutShortAreAsAlikeAsThoseOfAWholeOne) {
    RandomStream random(12, "alike");
    const Box box = square_box(20);
    StructureFactor whole({}, box, 320);
    StructureFactor cut({}, box, 640);
    Pattern p;
    for (int f = 0; f < 320; ++f) {
        if (f % 10 == 0) p = pattern(poisson_points(200, box, random), box, f);
        whole.add(whole.measure(p));
        cut.add(cut.measure(p));
    }
    const Spectrum all = whole.spectrum(StructureFactor::Estimator::raw);
    const Spectrum half = cut.spectrum(StructureFactor::Estimator::raw);
    double sum = 0;
    double of_cut = 0;
    for (std::size_t i = 0; i < all.dof.size(); ++i) {
        sum += all.dof[i];
        of_cut += half.dof[i];
    }
    // 1.35: eight blocks know how alike frames are less well than sixteen. Taken for
    // independent: 9.
    EXPECT_LT(of_cut / sum, 2);
    EXPECT_GT(of_cut / sum, 0.5);
}

}  // namespace
}  // namespace grainfield::analysis
