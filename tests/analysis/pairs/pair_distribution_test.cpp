#include "analysis/pairs/pair_distribution.h"

#include <cmath>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

const std::vector<double>& column(const ObservableResult& r, const char* curve, const char* name) {
    return r.find_curve(curve)->find(name)->values;
}

double value(const ObservableResult& r, const char* name) {
    return *r.find_measurement(name)->value;
}

Pattern random_layer(std::size_t n, const Box& box, int seed, std::int64_t frame = 0) {
    RandomStream random(static_cast<std::uint64_t>(seed), "layer");
    Pattern layer = pattern(poisson_points(n, box, random), box, frame);
    for (std::size_t i = 0; i < n; ++i) layer.z.push_back(0.5 + 0.94 * random.uniform());
    return layer;
}

PairDistribution measured_over(const std::vector<Pattern>& patterns,
                               const PairDistributionOptions& options = {}, std::int64_t whole = 0,
                               std::int64_t first = 0) {
    const auto frames = static_cast<std::int64_t>(patterns.size());
    PairDistribution pairs(options, patterns.front().box, whole > 0 ? whole : frames, first);
    for (std::int64_t f = 0; f < frames; ++f) {
        pairs.add(pairs.measure(patterns[static_cast<std::size_t>(f)], first + f));
    }
    return pairs;
}

// Two square layers, each sphere of one in a hollow of the other: all distances to the next are 1.
Pattern body_centred(int m) {
    const double length = m;
    Pattern crystal;
    crystal.box = square_box(length);
    for (int y = 0; y < m; ++y) {
        for (int x = 0; x < m; ++x) {
            crystal.position.push_back({x + 0.25, y + 0.25});
            crystal.z.push_back(0.5);
            crystal.position.push_back({x + 0.75, y + 0.75});
            crystal.z.push_back(0.5 + std::sqrt(0.5));
        }
    }
    return crystal;
}

TEST(PairDistribution, EqualsTheDefinitionPairByPair) {
    Box box = square_box(9, Boundary::walls, {2, -1});
    box.boundary[1] = Boundary::periodic;
    const Pattern layer = random_layer(60, box, 1);
    const PairDistributionOptions options{.range = 3.5, .bin = 0.25};
    // Along the walls .9 a are left free.
    const double length = 9 - 2 * 0.9;
    const auto is_seen = [](Vec2 p) { return p.x > 2.9 && p.x < 10.1; };
    const ObservableResult r = measured_over({layer}, options).result();
    const auto& space = column(r, "gr_space", "g");
    ASSERT_EQ(space.size(), 14U);
    const auto disc = [](double radius, double h) {
        return std::max(0.0, radius * radius - h * h);
    };
    for (std::size_t bin = 0; bin < space.size(); ++bin) {
        const double low = 0.25 * static_cast<double>(bin);
        const double high = low + 0.25;
        double weight = 0, plane_weight = 0, expected = 0, plane_expected = 0;
        for (std::size_t i = 0; i < layer.size(); ++i) {
            for (std::size_t j = 0; j < layer.size(); ++j) {
                if (i == j || !is_seen(layer.position[i]) || !is_seen(layer.position[j])) continue;
                const Vec2 s = box.minimum_image(layer.position[j] - layer.position[i]);
                const double h = layer.z[j] - layer.z[i];
                const double plane = std::hypot(s.x, s.y);
                const double r3 = std::hypot(plane, h);
                const double share = length / (length - std::abs(s.x));  // A/A_w
                weight += r3 >= low && r3 < high ? share : 0;
                plane_weight += plane >= low && plane < high ? share : 0;
                expected += std::numbers::pi * (disc(high, h) - disc(low, h)) / (9 * length);
                plane_expected += std::numbers::pi * (high * high - low * low) / (9 * length);
            }
        }
        EXPECT_NEAR(space[bin], weight / expected, 1e-11);
        EXPECT_NEAR(column(r, "gr", "g")[bin], plane_weight / plane_expected, 1e-11);
    }
}

// False alarms: 4 bins of some 20,000 pairs, at 6 standard errors: below 1e-7.
TEST(PairDistribution, IsOneForSpheresAtRandomInTheShallowestLayer) {
    for (const Boundary boundary : {Boundary::periodic, Boundary::walls}) {
        std::vector<Pattern> layers;
        for (int f = 0; f < 20; ++f) {
            layers.push_back(random_layer(600, square_box(25, boundary), 10 + 7 * f, f));
        }
        const ObservableResult r = measured_over(layers, {.range = 4, .bin = 1}).result();
        for (const char* curve : {"gr", "gr_space"}) {
            for (std::size_t bin = 0; bin < 4; ++bin) {
                const double pairs = column(r, curve, "n")[bin];
                EXPECT_NEAR(column(r, curve, "g")[bin], 1, 6 * 1.3 / std::sqrt(pairs));
            }
        }
    }
}

TEST(PairDistribution, CountsTheEightContactsOfABodyCentredLayer) {
    const ObservableResult r = measured_over({body_centred(12)}).result();
    EXPECT_EQ(value(r, "contact_number"), 8);
    EXPECT_EQ(column(r, "contacts", "share")[8], 1);
    EXPECT_EQ(value(r, "share_too_near"), 0);
    EXPECT_EQ(value(r, "known_heights"), 1);
    const auto& neighbours = column(r, "gr_space", "neighbours");
    const auto& distance = column(r, "gr_space", "r");
    for (std::size_t bin = 0; bin < distance.size(); ++bin) {
        if (distance[bin] < 0.98) {
            EXPECT_EQ(neighbours[bin], 0);
        }
        if (distance[bin] > 1.02 && distance[bin] < 1.39) {
            EXPECT_NEAR(neighbours[bin], 8, 1e-12);
        }
    }
}

// A cell 10 a high: spheres stand exactly above each other.
TEST(PairDistribution, CountsTheSixContactsOfASimpleCubicStack) {
    Pattern stack;
    stack.box = square_box(6);
    for (int i = 0; i < 6 * 6 * 5; ++i) {
        stack.position.push_back({i % 6 + 0.5, (i / 6) % 6 + 0.5});
        stack.z.push_back(i / 36 + 0.5);
    }
    const ObservableResult r = measured_over({stack}).result();
    EXPECT_NEAR(value(r, "contact_number"), (3 * 6 + 2 * 5) / 5.0, 1e-12);
    stack.position.push_back(stack.position[7]);
    stack.z.push_back(stack.z[7]);
    EXPECT_GT(value(measured_over({stack}).result(), "share_too_near"), 0);
}

TEST(PairDistribution, CountsMoreContactsThanItsTableHasRows) {
    const ObservableResult r = measured_over({body_centred(12)}, {.contact = 1.8}).result();
    EXPECT_EQ(value(r, "contact_number"), 8 + 4 + 8);
    EXPECT_EQ(column(r, "contacts", "share").back(), 1);
}

// Films show no centre within a quarter of a diameter of their border. As above for the alarms.
TEST(PairDistribution, IsOneWhereAStripAlongTheBorderIsEmpty) {
    std::vector<Pattern> layers;
    for (int f = 0; f < 20; ++f) {
        Pattern layer = random_layer(600, square_box(24, Boundary::walls), 500 + f, f);
        for (Vec2& p : layer.position) p = {0.5 + p.x * 23 / 24, 0.5 + p.y * 23 / 24};
        layers.push_back(layer);
    }
    const ObservableResult r = measured_over(layers, {.range = 4, .bin = 1}).result();
    for (std::size_t bin = 0; bin < 4; ++bin) {
        const double pairs = column(r, "gr", "n")[bin];
        EXPECT_NEAR(column(r, "gr", "g")[bin], 1, 6 * 1.3 / std::sqrt(pairs));
    }
}

// Grains gather at walls; what stands there is left out. As above for the alarms.
TEST(PairDistribution, IsOneBetweenWallsWhereGrainsGather) {
    std::vector<Pattern> layers;
    for (int f = 0; f < 20; ++f) {
        Pattern layer = random_layer(800, square_box(30, Boundary::walls), 900 + f, f);
        for (std::size_t i = 0; i < 100; ++i)
            layer.position[i].x = 0.5 + 0.001 * static_cast<double>(i);
        layers.push_back(layer);
    }
    const ObservableResult r = measured_over(layers, {.range = 4, .bin = 1}).result();
    for (std::size_t bin = 0; bin < 4; ++bin) {
        const double pairs = column(r, "gr", "n")[bin];
        EXPECT_NEAR(column(r, "gr", "g")[bin], 1, 6 * 1.3 / std::sqrt(pairs));
    }
}

TEST(PairDistribution, AFrozenCrystalHasAReasonInPlaceOfAnErrorOfZero) {
    const std::vector<Pattern> frozen(20, body_centred(8));
    const ObservableResult r = measured_over(frozen).result();
    EXPECT_FALSE(r.find_measurement("contact_number")->error);
    EXPECT_FALSE(r.find_measurement("contact_number")->reason.empty());
    for (const double error : column(r, "gr_space", "err")) EXPECT_FALSE(error == 0);
}

TEST(PairDistribution, SaysHowManySpheresAreNearerThanTheyCanBe) {
    Pattern crystal = body_centred(10);
    crystal.z[0] += 0.2;  // into the four above it
    const ObservableResult r = measured_over({crystal}).result();
    EXPECT_NEAR(value(r, "share_too_near"), 5.0 / 200, 1e-12);
    EXPECT_TRUE(r.find_measurement("contact_number")->value);
    for (std::size_t i = 0; i < 40; i += 2) crystal.z[i] += 0.2;
    const ObservableResult bad = measured_over({crystal}).result();
    EXPECT_NE(bad.find_measurement("contact_number")->reason.find("off"), std::string::npos);
}

TEST(PairDistribution, LeavesSpheresOfUnknownHeightOutOfSpaceButNotOutOfThePlane) {
    Pattern crystal = body_centred(10);
    for (std::size_t i = 0; i < crystal.size(); i += 4) crystal.z[i] = std::nan("");
    const ObservableResult r = measured_over({crystal}).result();
    EXPECT_NEAR(value(r, "known_heights"), 0.75, 1e-12);
    EXPECT_NE(r.find_measurement("contact_number")->reason.find("75 %"), std::string::npos);
    EXPECT_EQ(column(r, "gr", "n"), column(measured_over({body_centred(10)}).result(), "gr", "n"));
}

TEST(PairDistribution, WithoutHeightsIsOfThePlaneAloneAndSaysSo) {
    Pattern layer = random_layer(50, square_box(10), 3);
    layer.z.clear();
    const ObservableResult r = measured_over({layer}).result();
    EXPECT_NE(r.find_curve("gr"), nullptr);
    EXPECT_EQ(r.find_curve("gr_space"), nullptr);
    EXPECT_FALSE(r.find_measurement("contact_number")->value);
    EXPECT_NE(r.find_measurement("contact_number")->reason.find("heights"), std::string::npos);
}

TEST(PairDistribution, UsesNoMoreFramesThanAskedFor) {
    std::vector<Pattern> layers;
    for (int f = 0; f < 25; ++f) layers.push_back(random_layer(40, square_box(10), 5 + f, f));
    const ObservableResult few = measured_over(layers, {.frames = 5}).result();
    const ObservableResult all = measured_over(layers, {.frames = 0}).result();
    const auto pairs = [](const ObservableResult& r) {
        const auto& n = column(r, "gr", "n");
        return std::accumulate(n.begin(), n.end(), 0.0);
    };
    EXPECT_NEAR(pairs(few) / pairs(all), 0.2, 0.02);
}

// Blocks are independent: of 40 bins the pulls have a mean square between .3 and 3.
TEST(PairDistribution, ErrorsAreThoseOfIndependentFrames) {
    std::vector<Pattern> layers;
    for (int f = 0; f < 64; ++f) layers.push_back(random_layer(200, square_box(16), 90 + f, f));
    const ObservableResult r = measured_over(layers, {.range = 8, .bin = 0.2}).result();
    double squares = 0;
    for (std::size_t bin = 0; bin < 40; ++bin) {
        const double pull =
            (column(r, "gr_space", "g")[bin] - 1) / column(r, "gr_space", "err")[bin];
        squares += pull * pull / 40;
    }
    EXPECT_GT(squares, 0.3);
    EXPECT_LT(squares, 3);
}

TEST(PairDistribution, PartsMergedOrStoredGiveTheWhole) {
    std::vector<Pattern> layers;
    for (int f = 0; f < 12; ++f) layers.push_back(random_layer(40, square_box(10), 40 + f, f));
    const PairDistributionOptions options{.frames = 6};
    const ObservableResult whole = measured_over(layers, options).result();
    PairDistribution first = measured_over({layers.begin(), layers.begin() + 5}, options, 12);
    const PairDistribution second =
        measured_over({layers.begin() + 5, layers.end()}, options, 12, 5);
    Checkpoint stored;
    second.save(stored, "pairs.");
    PairDistribution restored(options, layers[0].box, 12, 5);
    restored.restore(stored, "pairs.");
    first.merge(restored);
    for (const char* name : {"g", "err", "n"}) {
        const auto& expected = column(whole, "gr_space", name);
        const auto& got = column(first.result(), "gr_space", name);
        for (std::size_t bin = 0; bin < expected.size(); ++bin) {
            if (std::isnan(expected[bin])) continue;
            EXPECT_NEAR(got[bin], expected[bin], 1e-12);
        }
    }
    EXPECT_EQ(value(first.result(), "contact_number"), value(whole, "contact_number"));
    PairDistribution other({.bin = 0.1}, layers[0].box, 12);
    EXPECT_THROW(other.restore(stored, "pairs."), InputError);
    stored.integers["pairs.counts"][3] = -1;
    EXPECT_THROW(restored.restore(stored, "pairs."), InputError);
}

TEST(PairDistribution, RefusesABoxThatChanges) {
    const PairDistribution pairs({}, square_box(10), 2);
    EXPECT_THROW(pairs.measure(random_layer(10, square_box(11), 1), 0), InputError);
}

TEST(PairDistribution, OfOneParticleOrNoRoomHasAReason) {
    EXPECT_FALSE(measured_over({random_layer(1, square_box(10), 1)}).result().reason.empty());
    EXPECT_FALSE(measured_over({random_layer(9, square_box(0.03), 1)}, {.bin = 0.02})
                     .result()
                     .reason.empty());
}

}  // namespace
}  // namespace grainfield::analysis
