#include "analysis/density/number_variance.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/support/checkpoint.h"
#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

const std::vector<double>& column(const ObservableResult& r, const char* curve, const char* name) {
    return r.find_curve(curve)->find(name)->values;
}

TEST(NumberVariance, EqualsTheDefinitionComputedWindowByWindow) {
    RandomStream random(1, "definition");
    const Box box = square_box(12, Boundary::walls);
    const NumberVarianceOptions options{.largest = 8, .step = 0.5, .border = 1.0};
    const int frames = 7;
    NumberVariance variance(options, box, frames);
    std::vector<Pattern> patterns;
    for (int f = 0; f < frames; ++f) {
        patterns.push_back(
            pattern(poisson_points(100 + static_cast<std::size_t>(10 * f), box, random), box, f));
        variance.add(variance.measure(patterns.back()));
    }
    const ObservableResult r = variance.result();
    const auto& l = column(r, "variance", "l");
    ASSERT_EQ(l.size(), 8U);
    for (std::size_t s = 0; s < l.size(); ++s) {
        double temporal = 0, sum = 0, squares = 0, windows = 0;
        for (double y = 1; y + l[s] <= 11; y += 0.5) {
            for (double x = 1; x + l[s] <= 11; x += 0.5) {
                std::vector<double> n;
                for (const Pattern& p : patterns) {
                    double count = 0;
                    for (Vec2 q : p.position) {
                        count += q.x >= x && q.x < x + l[s] && q.y >= y && q.y < y + l[s];
                    }
                    n.push_back(count);
                }
                double mean = 0;
                for (double v : n) mean += v / frames;
                for (double v : n) {
                    temporal += (v - mean) * (v - mean) / (frames - 1);
                    sum += v / frames;
                    squares += v * v / frames;
                }
                windows += 1;
            }
        }
        EXPECT_NEAR(column(r, "variance", "variance")[s], temporal / windows, 1e-11);
        EXPECT_NEAR(column(r, "variance", "mean")[s], sum / windows, 1e-11);
        EXPECT_NEAR(column(r, "variance_pooled", "variance")[s],
                    squares / windows - (sum / windows) * (sum / windows), 1e-10);
    }
}

TEST(NumberVariance, OfAStaticPatternIsZeroInTimeButNotPooled) {
    RandomStream random(2, "static");
    const Box box = square_box(40, Boundary::walls);
    const Pattern p = pattern(poisson_points(1600, box, random), box);
    NumberVariance variance({}, box, 10);
    for (int f = 0; f < 10; ++f) variance.add(variance.measure(p));
    const ObservableResult r = variance.result();
    for (double v : column(r, "variance", "variance")) EXPECT_EQ(v, 0);
    EXPECT_GT(column(r, "variance_pooled", "variance")[3], 1);
}

TEST(NumberVariance, OfOneFrameIsPooledAndSaysSo) {
    RandomStream random(3, "one");
    const Box box = square_box(60, Boundary::walls);
    NumberVariance variance({}, box, 1);
    variance.add(variance.measure(pattern(poisson_points(3600, box, random), box)));
    const ObservableResult r = variance.result();
    EXPECT_EQ(column(r, "variance", "variance"), column(r, "variance_pooled", "variance"));
    EXPECT_NE(r.find_measurement("relative_variance_10a_pooled")->reason.find("one frame"),
              std::string::npos);
    EXPECT_TRUE(r.find_measurement("relative_variance_10a_pooled")->error.has_value());
    // Windows that leave no second independent one have no error.
    EXPECT_TRUE(std::isnan(column(r, "variance", "err").back()));
}

// The result of the frames, all but one.
ObservableResult variance_without(const std::vector<Pattern>& frames, std::size_t without) {
    NumberVariance variance({}, frames.front().box, static_cast<std::int64_t>(frames.size()) - 1);
    for (std::size_t f = 0; f < frames.size(); ++f) {
        if (f != without) variance.add(variance.measure(frames[f]));
    }
    return variance.result();
}

TEST(NumberVariance, HasAnErrorWithStudentsFactorFromTheBlocksThatHoldFrames) {
    RandomStream random(9, "student");
    const Box box = square_box(40);
    std::vector<Pattern> frames;
    for (int f = 0; f < 5; ++f) {
        frames.push_back(pattern(poisson_points(1600, box, random), box, f));
    }
    NumberVariance variance({}, box, 16);  // a run that was cut short: 11 blocks are empty
    for (const Pattern& p : frames) variance.add(variance.measure(p));
    const ObservableResult r = variance.result();
    for (const char* curve : {"variance", "variance_slope"}) {
        const char* value = std::string(curve) == "variance" ? "variance" : "beta";
        std::vector<double> left;
        for (std::size_t f = 0; f < frames.size(); ++f) {
            left.push_back(column(variance_without(frames, f), curve, value)[3]);
        }
        EXPECT_NEAR(column(r, curve, "err")[3], *student_jackknife_error(left), 1e-12) << curve;
    }
}

TEST(NumberVariance, OfThreeFramesHasAReasonInPlaceOfAnError) {
    RandomStream random(10, "few");
    const Box box = square_box(40);
    NumberVariance variance({}, box, 3);
    for (int f = 0; f < 3; ++f) {
        variance.add(variance.measure(pattern(poisson_points(1600, box, random), box, f)));
    }
    const ObservableResult r = variance.result();
    const Measurement* m = r.find_measurement("relative_variance_10a");
    EXPECT_TRUE(m->value.has_value());
    EXPECT_FALSE(m->error.has_value());
    EXPECT_NE(m->reason.find("fewer than four blocks"), std::string::npos) << m->reason;
    EXPECT_TRUE(std::isnan(column(r, "variance", "err")[3]));
}

// A run that is cut short, with blocks of unequal length: every window of every frame is counted.
TEST(NumberVariance, AddsTheVarianceOfTheMeansOfItsPositions) {
    RandomStream random(12, "drift");
    const Box box = square_box(8);
    constexpr int planned = 45;
    constexpr int frames = 41;
    constexpr int side = 3;
    NumberVariance variance({.smallest = side, .largest = side, .step = 1}, box, planned);
    std::vector<Vec2> points = poisson_points(70, box, random);
    std::vector<std::vector<double>> contents(64);  // of each position, by frames
    for (int f = 0; f < frames; ++f) {
        variance.add(variance.measure(pattern(points, box, f)));
        for (int p = 0; p < 64; ++p) {
            double count = 0;
            for (const Vec2 q : points) {
                count += box.wrap(q - Vec2{1.0 * (p % 8), 1.0 * (p / 8)}).x < side &&
                         box.wrap(q - Vec2{1.0 * (p % 8), 1.0 * (p / 8)}).y < side;
            }
            contents[static_cast<std::size_t>(p)].push_back(count);
        }
        for (Vec2& p : points) {
            p = box.wrap(p + Vec2{0.4 * random.normal(), 0.4 * random.normal()});
        }
    }
    const BlockPlan plan = BlockPlan::of(planned);
    std::vector<double> lengths(static_cast<std::size_t>(plan.block_of(frames - 1)) + 1, 0.0);
    for (int f = 0; f < frames; ++f) ++lengths[static_cast<std::size_t>(plan.block_of(f))];
    BlockScatter scatter;
    double plain = 0;
    for (const std::vector<double>& n : contents) {
        std::vector<double> means(lengths.size(), 0.0);
        double mean = 0;
        for (int f = 0; f < frames; ++f) {
            const auto b = static_cast<std::size_t>(plan.block_of(f));
            means[b] += n[static_cast<std::size_t>(f)] / lengths[b];
            mean += n[static_cast<std::size_t>(f)] / frames;
        }
        for (const double x : n) plain += (x - mean) * (x - mean) / frames / 64;
        add_scatter<double>(scatter, lengths, means);
    }
    scatter.squares /= 64;
    scatter.steps /= 64;
    const BlockDrift drift = block_drift(scatter, lengths.size());
    ASSERT_GT(drift.variance_of_mean, 1.2 * plain / (frames - 1));
    EXPECT_NEAR(column(variance.result(), "variance", "variance")[0],
                plain + drift.variance_of_mean, 1e-9);
}

TEST(NumberVariance, NamesItsReadingsApartSoThatNoneIsComparedWithAnother) {
    RandomStream random(7, "names");
    const Box box = square_box(60, Boundary::walls);
    const Pattern p = pattern(poisson_points(3600, box, random), box);
    const auto names = [&](VarianceReading reading, int frames) {
        NumberVariance variance({.reading = reading}, box, frames);
        for (int f = 0; f < frames; ++f) variance.add(variance.measure(p));
        return variance.result().measurements.back().name;
    };
    EXPECT_EQ(names(VarianceReading::temporal, 4), "relative_variance_10a");
    EXPECT_EQ(names(VarianceReading::pooled, 4), "relative_variance_10a_pooled");
    EXPECT_EQ(names(VarianceReading::temporal, 1), "relative_variance_10a_pooled");
    EXPECT_EQ(names(VarianceReading::spatial_mean, 4), "relative_variance_10a_spatial_mean");
}

TEST(NumberVariance, LeavesOutWindowsLargerThanTheBox) {
    const Box box = square_box(30, Boundary::walls);
    RandomStream random(4, "large");
    NumberVariance variance({}, box, 1);
    variance.add(variance.measure(pattern(poisson_points(900, box, random), box)));
    EXPECT_DOUBLE_EQ(column(variance.result(), "variance", "l").back(), 24);  // 30 − 2 · 3
    NumberVariance none({.smallest = 25}, box, 1);
    none.add(none.measure(pattern(poisson_points(900, box, random), box)));
    EXPECT_NE(none.result().reason.find("no window fits"), std::string::npos);
}

TEST(NumberVariance, OfTwoMergedHalvesIsThatOfTheWhole) {
    RandomStream random(5, "merge");
    const Box box = square_box(30, Boundary::walls);
    NumberVariance whole({}, box, 10), first({}, box, 5), second({}, box, 5);
    for (int f = 0; f < 10; ++f) {
        const auto sample = whole.measure(pattern(poisson_points(900, box, random), box, f));
        whole.add(sample);
        (f < 5 ? first : second).add(sample);
    }
    first.merge(second);
    EXPECT_EQ(column(whole.result(), "variance", "variance"),
              column(first.result(), "variance", "variance"));
    EXPECT_EQ(column(whole.result(), "variance", "err"), column(first.result(), "variance", "err"));
}

// A damaged checkpoint; the square of 2^126 overflowed.
TEST(NumberVariance, RefusesStoredSumsThatNoFramesGive) {
    RandomStream random(5, "stored");
    const Box box = square_box(4, Boundary::walls);
    NumberVariance variance({}, box, 2);
    for (int f = 0; f < 2; ++f) {
        variance.add(variance.measure(pattern(poisson_points(16, box, random), box, f)));
    }
    Checkpoint whole;
    variance.save(whole, "");
    NumberVariance({}, box, 2).restore(whole, "");
    const std::size_t numbers = whole.integers["counts"].size();
    for (std::size_t i = 0; i < numbers; ++i) {
        Checkpoint damaged = whole;
        damaged.integers["counts"][i] = -1;
        EXPECT_THROW(NumberVariance({}, box, 2).restore(damaged, ""), InputError) << i;
        damaged.integers["counts"][i] = std::int64_t{1} << 62;
        NumberVariance taken({}, box, 2);
        try {
            taken.restore(damaged, "");
            taken.result();
        } catch (const InputError&) {
            continue;
        }
    }
}

TEST(NumberVariance, OfAPeriodicBoxVanishesForTheWholeBox) {
    RandomStream random(6, "whole");
    const Box box = square_box(20);
    NumberVariance variance({}, box, 3);
    for (int f = 0; f < 3; ++f) {
        variance.add(variance.measure(pattern(poisson_points(400, box, random), box, f)));
    }
    const ObservableResult r = variance.result();
    EXPECT_DOUBLE_EQ(column(r, "variance", "l").back(), 20);
    EXPECT_EQ(column(r, "variance", "variance").back(), 0);
}

TEST(NumberVariance, IsUnchangedFarFromTheOrigin) {
    // Coordinates in steps of 1/16 a, so that moving them by 1e6 a loses nothing.
    RandomStream random(7, "far");
    const Box near_box = square_box(40, Boundary::walls);
    const Box far_box = square_box(40, Boundary::walls, {1e6, -1e6});
    std::vector<Vec2> points, far;
    for (int i = 0; i < 1600; ++i) {
        points.push_back({static_cast<double>(random.below(640)) / 16,
                          static_cast<double>(random.below(640)) / 16});
        far.push_back(points.back() + Vec2{1e6, -1e6});
    }
    NumberVariance a({}, near_box, 1), b({}, far_box, 1);
    a.add(a.measure(pattern(points, near_box)));
    b.add(b.measure(pattern(far, far_box)));
    EXPECT_EQ(column(a.result(), "variance", "variance"),
              column(b.result(), "variance", "variance"));
}

TEST(NumberVariance, GivesReasonsWithoutDataAndRefusesABoxThatChanges) {
    const Box box = square_box(30);
    EXPECT_EQ(NumberVariance({}, box, 0).result().reason, "no frames");
    NumberVariance empty({}, box, 1);
    empty.add(empty.measure(pattern({}, box)));
    EXPECT_EQ(empty.result().reason, "no particles");
    EXPECT_THROW(empty.measure(pattern({}, square_box(31))), InputError);
}

}  // namespace
}  // namespace grainfield::analysis
