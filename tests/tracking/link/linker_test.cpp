#include "tracking/link/linker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/support/random.h"
#include "tests/support/layer_frames.h"

namespace grainfield::tracking {
namespace {

TEST(Linker, KeepsIdentitiesWhateverTheOrderOfTheParticles) {
    Linker linker({.search_range = 3, .memory = 0});
    const auto first = linker.link(0, {{10, 10}, {20, 20}, {30, 30}});
    const auto second = linker.link(1, {{30.5, 30}, {10, 11}, {20, 19.2}});
    EXPECT_EQ(second, (std::vector<std::int64_t>{first[2], first[0], first[1]}));
}

TEST(Linker, StartsNewTracksBeyondTheSearchRange) {
    Linker linker({.search_range = 3, .memory = 0});
    linker.link(0, {{10, 10}});
    EXPECT_EQ(linker.link(1, {{13.01, 10}}), std::vector<std::int64_t>{1});
    EXPECT_EQ(linker.summary().started, 2);
    linker.link(2, {});
    EXPECT_EQ(linker.summary().ended, 1);
}

TEST(Linker, MemoryBridgesAMissingDetectionAndNoMore) {
    Linker linker({.search_range = 3, .memory = 2});
    linker.link(0, {{10, 10}, {50, 50}});
    linker.link(1, {{50, 50}});
    linker.link(2, {{50, 50}});
    EXPECT_EQ(linker.link(3, {{10.5, 10}, {50, 50}})[0], 0);
    EXPECT_EQ(linker.summary().bridged, 1);

    Linker forgetful({.search_range = 3, .memory = 1});
    forgetful.link(0, {{10, 10}});
    forgetful.link(1, {});
    forgetful.link(2, {});
    EXPECT_EQ(forgetful.link(3, {{10, 10}})[0], 1);
}

TEST(Linker, AFrameThatIsLeftOutCountsAsMissing) {
    Linker linker({.search_range = 3, .memory = 0});
    linker.link(0, {{10, 10}});
    EXPECT_EQ(linker.link(2, {{10, 10}})[0], 1);
}

TEST(Linker, NearestPairsAreTakenFirst) {
    Linker linker({.search_range = 5, .memory = 0});
    linker.link(0, {{10, 10}, {14, 10}});
    // The second track is nearer to the only particle.
    EXPECT_EQ(linker.link(1, {{13, 10}})[0], 1);
}

TEST(Linker, MakesNoWrongLinkInADenseLayerAtATenthOfTheSpacing) {
    auto scene = testing::hard_disc_liquid(400, 400, 10, 0.7, 8);
    std::vector<Vec2> positions = scene.position;
    Linker linker({.search_range = 5, .memory = 0});
    const auto ids = linker.link(0, positions);
    RandomStream random(4, "steps");
    for (int frame = 1; frame < 20; ++frame) {
        for (Vec2& p : positions) p += Vec2{0.5 * random.normal(), 0.5 * random.normal()};
        // Steps are RMS 0.7 px; half the smallest spacing is 5 px, a wrong link needs 7 σ.
        const auto now = linker.link(frame, positions);
        ASSERT_EQ(now, ids) << frame;
        positions = scene.position;
    }
}

TEST(Linker, GivesUpTheNearestPairWhereTheSumOfSquaresIsLess) {
    Linker linker({.search_range = 5, .memory = 0});
    const auto first = linker.link(0, {{10, 10}, {13, 10}});
    // Nearest first joins the particle at 12.5 to the second track and leaves 16.5 no one within
    // reach; both moved by about 3 px.
    EXPECT_EQ(linker.link(1, {{12.5, 10}, {16.5, 10}}), first);
    EXPECT_EQ(linker.summary().subnets.subnets, 1);
}

TEST(Linker, MergersAndSplitsAreCounted) {
    Linker linker({.search_range = 3, .memory = 0});
    linker.link(0, {{10, 10}, {14, 10}, {50, 50}});
    linker.link(1, {{11.9, 10}, {50, 50}});
    EXPECT_EQ(linker.summary().merged, 1);
    EXPECT_EQ(linker.summary().split, 0);
    linker.link(2, {{11, 10}, {13.5, 10}, {80, 80}});  // 50, 50 leaves without a rival
    EXPECT_EQ(linker.summary().merged, 1);
    EXPECT_EQ(linker.summary().split, 1);
}

TEST(Linker, DriftIsFollowedBeyondHalfTheSpacing) {
    // A lattice of spacing 4 that speeds up to 3 px a frame: without prediction the nearest
    // particle is the wrong one.
    std::vector<Vec2> lattice;
    for (int i = 0; i < 400; ++i) lattice.push_back({4.0 * (i % 20), 4.0 * (i / 20)});
    const auto wrong = [&](Predictor predictor) {
        Linker linker({.search_range = 2, .memory = 0, .predictor = predictor});
        std::vector<std::int64_t> first;
        std::int64_t errors = 0;
        double shift = 0;
        for (int frame = 0; frame < 10; ++frame) {
            shift += std::min(3.0, 0.8 * frame);
            std::vector<Vec2> now = lattice;
            for (Vec2& p : now) p += {shift, -0.5 * shift};
            const auto ids = linker.link(frame, now);
            if (frame == 0) first = ids;
            for (std::size_t i = 0; i < ids.size(); ++i) errors += ids[i] != first[i];
        }
        return errors;
    };
    EXPECT_EQ(wrong(Predictor::drift), 0);
    EXPECT_EQ(wrong(Predictor::nearest_velocity), 0);
    EXPECT_GT(wrong(Predictor::none), 1000);
}

TEST(Linker, VelocityBridgesAGapThatIsLongerThanTheSearchRange) {
    const auto last_id = [](Predictor predictor) {
        Linker linker({.search_range = 2, .memory = 3, .predictor = predictor});
        linker.link(0, {{10, 10}});
        linker.link(1, {{11.5, 10}});
        linker.link(2, {});
        linker.link(3, {});
        return linker.link(4, {{16, 10}})[0];
    };
    EXPECT_EQ(last_id(Predictor::nearest_velocity), 0);
    EXPECT_EQ(last_id(Predictor::drift), 0);
    EXPECT_EQ(last_id(Predictor::none), 1);
}

TEST(Linker, EqualErrorsChangeNothing) {
    RandomStream random(9, "steps");
    Linker plain({.search_range = 4, .memory = 2});
    Linker weighted({.search_range = 4, .memory = 2});
    auto scene = testing::hard_disc_liquid(200, 200, 8, 0.7, 3);
    for (int frame = 0; frame < 5; ++frame) {
        for (Vec2& p : scene.position) p += Vec2{random.normal(), random.normal()};
        const std::vector<Vec2> errors(scene.position.size(), Vec2{0.3, 0.3});
        EXPECT_EQ(weighted.link(frame, scene.position, errors), plain.link(frame, scene.position));
    }
}

TEST(Linker, WeightsByErrorsMakeFewerWrongLinks) {
    RandomStream random(10, "steps");
    std::int64_t plain_wrong = 0;
    std::int64_t weighted_wrong = 0;
    const auto scene = testing::hard_disc_liquid(400, 400, 8, 0.7, 3);
    for (int trial = 0; trial < 10; ++trial) {
        Linker plain({.search_range = 14, .memory = 0});
        Linker weighted({.search_range = 14, .memory = 0});
        std::vector<std::int64_t> first;
        for (int frame = 0; frame < 3; ++frame) {
            // Small steps, but every third sphere is seen with an error of 0.4 diameters.
            std::vector<Vec2> seen = scene.position;
            std::vector<Vec2> errors;
            for (std::size_t i = 0; i < seen.size(); ++i) {
                const double e = i % 3 == 0 ? 3.0 : 0.1;
                errors.push_back({e, e});
                seen[i] += std::hypot(e, 0.3) * Vec2{random.normal(), random.normal()};
            }
            const auto a = plain.link(frame, seen);
            const auto b = weighted.link(frame, seen, errors);
            if (frame == 0) first = a;
            if (frame < 2) continue;  // what a step is must be learned first
            for (std::size_t i = 0; i < a.size(); ++i) {
                plain_wrong += a[i] != first[i];
                weighted_wrong += b[i] != first[i];
            }
        }
    }
    EXPECT_GT(plain_wrong, 100);
    EXPECT_LT(static_cast<double>(weighted_wrong), 0.9 * static_cast<double>(plain_wrong));
}

TEST(Linker, ErrorsThatAreNotNumbersOrAbsurdDoNotDisturbTheOthers) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto scene = testing::hard_disc_liquid(200, 200, 8, 0.7, 3);
    std::vector<Vec2> errors(scene.position.size(), Vec2{0.1, 0.1});
    errors[0] = {nan, -1};
    errors[1] = {1e9, 1e300};
    errors[2] = {std::numeric_limits<double>::infinity(), 0};
    RandomStream random(15, "steps");
    Linker linker({.search_range = 4, .memory = 0});
    const auto first = linker.link(0, scene.position, errors);
    for (int frame = 1; frame < 4; ++frame) {
        auto seen = scene.position;
        for (Vec2& p : seen) p += 0.3 * Vec2{random.normal(), random.normal()};
        EXPECT_EQ(linker.link(frame, seen, errors), first);
    }
}

TEST(Linker, BadFramesAreRefusedAndLeaveTheStateAsItWas) {
    Linker linker({.search_range = 3, .memory = 0});
    linker.link(4, {{10, 10}});
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(linker.link(4, {{10, 10}}), InputError);
    EXPECT_THROW(linker.link(5, {{nan, 10}}), InputError);
    EXPECT_THROW(linker.link(5, {{10, 10}}, {{1, 1}, {1, 1}}), InputError);
    EXPECT_EQ(linker.link(5, {{10, 10}})[0], 0);
    EXPECT_THROW(Linker({.search_range = 0}), OptionError);
    EXPECT_THROW(Linker(LinkOptions{}), OptionError);
}

TEST(Linker, ARestoredStateGoesOnWithTheSameIdentities) {
    const LinkOptions options{
        .search_range = 4, .memory = 2, .predictor = Predictor::nearest_velocity};
    auto scene = testing::hard_disc_liquid(200, 200, 8, 0.7, 3);
    RandomStream random(11, "steps");
    Linker whole(options);
    Linker resumed(options);
    for (int frame = 0; frame < 8; ++frame) {
        std::vector<Vec2> seen;
        for (Vec2& p : scene.position) {
            p += Vec2{random.normal(), random.normal()};
            if (random.uniform() > 0.1) seen.push_back(p);
        }
        const std::vector<Vec2> errors(seen.size(), Vec2{0.2, 0.1});
        if (frame == 4) resumed.restore(whole.state());
        const auto ids = whole.link(frame, seen, errors);
        if (frame < 4) continue;
        EXPECT_EQ(resumed.link(frame, seen, errors), ids) << frame;
    }
    EXPECT_EQ(resumed.summary().linked, whole.summary().linked);
}

TEST(Linker, MemoryDoesNotGrowWithTheVideo) {
    Linker linker({.search_range = 1, .memory = 2});
    RandomStream random(12, "places");
    for (int frame = 0; frame < 300; ++frame) {
        std::vector<Vec2> noise;  // nothing ever continues
        for (int i = 0; i < 50; ++i)
            noise.push_back({random.uniform(0, 1e6), random.uniform(0, 1e6)});
        linker.link(frame, noise);
        EXPECT_LE(linker.state().tracks.size(), 50u * 4);
    }
}

TEST(Linker, AllLeavingAndComingBackInOtherNumbersIsHandled) {
    Linker linker({.search_range = 2, .memory = 1});
    std::vector<Vec2> many;
    for (int i = 0; i < 1000; ++i) many.push_back({5.0 * (i % 40), 5.0 * (i / 40)});
    const std::vector<Vec2> few(many.begin(), many.begin() + 10);
    const auto first = linker.link(0, many);
    const auto kept = linker.link(1, few);
    EXPECT_TRUE(std::equal(kept.begin(), kept.end(), first.begin()));
    EXPECT_EQ(linker.link(2, many), first);  // within the memory
    EXPECT_TRUE(linker.link(3, {}).empty());
    EXPECT_TRUE(linker.link(4, {}).empty());
    const auto fresh = linker.link(5, many);
    EXPECT_EQ(fresh[0], 1000);
    EXPECT_EQ(linker.summary().ended, 1000);
}

TEST(Linker, WarnsOfStepsAboveAQuarterOfTheDiameterAndOfASearchRangeTooSmall) {
    const auto scene = testing::hard_disc_liquid(300, 300, 10, 0.6, 8);
    const auto warnings = [&](double step, double range) {
        RandomStream random(13, "steps");
        Linker linker({.search_range = range, .memory = 0});
        linker.link(0, scene.position);
        auto moved = scene.position;
        for (Vec2& p : moved) p += (step / std::sqrt(2)) * Vec2{random.normal(), random.normal()};
        linker.link(1, moved);
        return linker.warnings(10);
    };
    EXPECT_TRUE(warnings(1, 5).empty());
    ASSERT_EQ(warnings(6, 8).size(), 1u);
    EXPECT_NE(warnings(6, 8)[0].find("identities are doubtful"), std::string::npos);
    ASSERT_EQ(warnings(2, 2).size(), 1u);
    EXPECT_NE(warnings(2, 2)[0].find("link.search-range is too small"), std::string::npos);
}

TEST(Linker, ASearchRangeThatIsNotGivenFollowsTheMotion) {
    const auto scene = testing::hard_disc_liquid(400, 400, 10, 0.72, 8);
    RandomStream random(14, "steps");
    Linker linker({.search_range = std::nullopt, .memory = 0}, 10);
    const auto link = [&](int frame, double step) {
        auto moved = scene.position;
        for (Vec2& p : moved) p += (step / 2) * Vec2{random.normal(), random.normal()};
        linker.link(frame, moved);
        return linker.summary().range;
    };
    link(0, 1);
    EXPECT_EQ(link(1, 1), 5);  // 4.5 · 1/√2 is less than D/2
    link(2, 2.8);
    // The frame itself asks for more: 4.5 · 2.8/√2 = 8.9; the median of 1,000 steps is good to 5 %.
    EXPECT_NEAR(link(3, 2.8), 8.9, 1.0);
    link(4, 9);
    EXPECT_EQ(link(5, 9), 10);
    link(6, 1);
    link(7, 1);
    EXPECT_EQ(link(8, 1), 5);
}

TEST(Linker, AFewFastParticlesAmongManySlowOnesKeepTheirIdentity) {
    // Ten walkers of 0.65 D a frame through a dilute field at rest.
    std::vector<Vec2> places = testing::isolated_discs(600, 600, 10, 40, 3).position;
    const std::size_t resting = places.size();
    for (int i = 0; i < 10; ++i) places.push_back({60.0 + 40 * i, 80.0 + 40 * i});
    Linker linker({.search_range = std::nullopt, .memory = 0}, 10);
    const auto first = linker.link(0, places);
    for (int f = 1; f < 5; ++f) {
        for (std::size_t i = resting; i < places.size(); ++i) places[i] += Vec2{6.5, 0};
        EXPECT_EQ(linker.link(f, places), first) << f;
    }
    EXPECT_EQ(linker.summary().range, 10);
}

TEST(Linker, FastParticlesAreFollowedByTheirLastStepWhereOthersComeAndGo) {
    // Three roll over a bed at rest, faster and faster, while others come in at the border.
    std::vector<Vec2> places = testing::isolated_discs(460, 115, 10, 23, 3).position;
    const std::size_t resting = places.size();
    for (int i = 0; i < 3; ++i) places.push_back({80.0 + 100 * i, 3});
    Linker linker({.search_range = std::nullopt, .memory = 0}, 10);
    auto expected = linker.link(0, places);
    for (int f = 1; f < 8; ++f) {
        for (std::size_t i = resting; i < resting + 3; ++i) places[i].x += 3.7 + 0.4 * f;
        for (const double x : {2, 452}) places.push_back({x, 10.0 + 12 * f});
        const auto found = linker.link(f, places);
        ASSERT_TRUE(std::equal(expected.begin(), expected.end(), found.begin())) << f;
        expected = found;
    }
    EXPECT_EQ(linker.summary().range, 10);
}

TEST(Linker, MissingParticlesAreNotTakenForFastOnes) {
    // 5 % of a dense liquid missing in each frame, others in the next: without memory each return
    // is a new track, and none may be given to a neighbour that went missing.
    const auto scene = testing::hard_disc_liquid(500, 500, 10, 0.72, 8);
    RandomStream random(15, "dropouts");
    Linker linker({.search_range = std::nullopt, .memory = 0}, 10);
    std::vector<std::int64_t> owner;
    for (int f = 0; f < 10; ++f) {
        std::vector<Vec2> seen;
        std::vector<std::size_t> which;
        for (std::size_t i = 0; i < scene.position.size(); ++i) {
            if (random.uniform() < 0.05) continue;
            seen.push_back(scene.position[i] + 0.4 * Vec2{random.normal(), random.normal()});
            which.push_back(i);
        }
        const auto ids = linker.link(f, seen);
        EXPECT_TRUE(f == 0 || linker.summary().range == 5);
        for (std::size_t k = 0; k < ids.size(); ++k) {
            const auto id = static_cast<std::size_t>(ids[k]);
            if (id >= owner.size()) owner.resize(id + 1, -1);
            if (owner[id] < 0) owner[id] = static_cast<std::int64_t>(which[k]);
            EXPECT_EQ(owner[id], static_cast<std::int64_t>(which[k]));
        }
    }
}

TEST(Linker, AnAbsurdSearchRangeIsBoundedAndWarnedOf) {
    const auto scene = testing::hard_disc_liquid(300, 300, 8, 0.7, 8);
    Linker linker({.search_range = 100, .memory = 0, .largest_subnet = 5000});
    const auto first = linker.link(0, scene.position);
    EXPECT_EQ(linker.link(1, scene.position), first);
    EXPECT_GT(linker.summary().crowded, 0);
    EXPECT_EQ(linker.summary().subnets.reduced, 1);
    EXPECT_EQ(linker.warnings(8).size(), 2u);
}

TEST(Linker, ManyParticlesAtOnePointAndNoneAtAllAreHarmless) {
    Linker linker({.search_range = 1, .memory = 1});
    linker.link(0, std::vector<Vec2>(300, Vec2{5, 5}));
    auto ids = linker.link(1, std::vector<Vec2>(300, Vec2{5, 5}));
    std::sort(ids.begin(), ids.end());
    EXPECT_EQ(std::unique(ids.begin(), ids.end()), ids.end());
    EXPECT_TRUE(linker.link(2, {}).empty());
}

}  // namespace
}  // namespace grainfield::tracking
