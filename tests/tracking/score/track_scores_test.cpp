#include "tracking/score/track_scores.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::tracking {
namespace {

using Movie = std::vector<IdentifiedFrame>;

/// Two particles 100 px apart that stand still for four frames.
Movie two_still() {
    return Movie(4, {{0, 1}, {{0, 0}, {100, 0}}});
}

TEST(TrackScores, PerfectTracksScoreOneUnderAnyNames) {
    Movie found = two_still();
    for (IdentifiedFrame& f : found) f = {{70, 30}, {{100, 0}, {0, 0}}};
    const TrackScores s = score_tracks(found, two_still(), 4);
    EXPECT_EQ(s.alpha, 1);
    EXPECT_EQ(s.beta, 1);
    EXPECT_EQ(s.jaccard_points, 1);
    EXPECT_EQ(s.jaccard_tracks, 1);
    EXPECT_EQ(s.switches, 0);
    EXPECT_EQ(s.fragments, 0);
    EXPECT_EQ(s.links, 6);
}

TEST(TrackScores, NothingFoundScoresZero) {
    const TrackScores s = score_tracks(Movie(4), two_still(), 4);
    EXPECT_EQ(s.alpha, 0);
    EXPECT_EQ(s.beta, 0);
    EXPECT_EQ(s.jaccard_points, 0);
    EXPECT_EQ(s.jaccard_tracks, 0);
}

TEST(TrackScores, AConstantOffsetCostsItsShareOfTheGate) {
    Movie found = two_still();
    for (IdentifiedFrame& f : found) f.position[0].x += 1;
    // One of two tracks is 1 px of ε = 4 px off: d = 4 · 1, d(X, ∅) = 2 · 4 · 4.
    const TrackScores s = score_tracks(found, two_still(), 4);
    EXPECT_DOUBLE_EQ(s.alpha, 1 - 4.0 / 32);
    EXPECT_DOUBLE_EQ(s.beta, s.alpha);
    EXPECT_EQ(s.jaccard_points, 1);
}

TEST(TrackScores, ASpuriousTrackLowersBetaAndTheJaccardsButNotAlpha) {
    Movie found = two_still();
    found[1].id.push_back(9);
    found[1].position.push_back({50, 50});
    const TrackScores s = score_tracks(found, two_still(), 4);
    EXPECT_EQ(s.alpha, 1);
    EXPECT_DOUBLE_EQ(s.beta, 32.0 / 36);  // one spurious frame of ε
    EXPECT_DOUBLE_EQ(s.jaccard_points, 8.0 / 9);
    EXPECT_DOUBLE_EQ(s.jaccard_tracks, 2.0 / 3);
}

TEST(TrackScores, ExchangedIdentitiesAreTwoSwitches) {
    Movie found = two_still();
    for (std::size_t f = 2; f < 4; ++f) found[f].id = {1, 0};
    const TrackScores s = score_tracks(found, two_still(), 4);
    EXPECT_EQ(s.switches, 2);
    EXPECT_EQ(s.wrong_links, 2);
    EXPECT_EQ(s.fragments, 0);
    // Each pairing has half the frames at ε: d = 2 · 2 · 4 of 32.
    EXPECT_DOUBLE_EQ(s.alpha, 0.5);
    EXPECT_DOUBLE_EQ(s.jaccard_points, 4.0 / 12);
    EXPECT_EQ(s.jaccard_tracks, 1);
}

TEST(TrackScores, AGapIsAFragmentAndASwitchOnlyWithANewName) {
    Movie bridged = two_still();
    bridged[1] = {{1}, {{100, 0}}};
    TrackScores s = score_tracks(bridged, two_still(), 4);
    EXPECT_EQ(s.fragments, 1);
    EXPECT_EQ(s.switches, 0);
    EXPECT_DOUBLE_EQ(s.alpha, 1 - 4.0 / 32);

    Movie broken = bridged;
    for (std::size_t f = 2; f < 4; ++f) broken[f].id[0] = 5;
    s = score_tracks(broken, two_still(), 4);
    EXPECT_EQ(s.fragments, 1);
    EXPECT_EQ(s.switches, 1);
    EXPECT_EQ(s.wrong_links, 0);
    // The longer half (2 frames) is paired, 2 frames are missed, the other half is spurious.
    EXPECT_DOUBLE_EQ(s.alpha, 1 - 8.0 / 32);
    EXPECT_DOUBLE_EQ(s.beta, 24.0 / 36);
    EXPECT_DOUBLE_EQ(s.jaccard_tracks, 2.0 / 3);
}

TEST(TrackScores, TracksArePairedForTheLeastTotalNotNearestFirst) {
    // Found 7 is 1 px from true 0 and 1.5 px from true 1; found 8 only comes near true 0.
    const Movie truth(1, {{0, 1}, {{0, 0}, {2.5, 0}}});
    const Movie found(1, {{7, 8}, {{1, 0}, {-2, 0}}});
    // 7–1 and 8–0: 1.5 + 2 = 3.5; nearest first would leave 1 alone: 1 + 3 = 4.
    EXPECT_DOUBLE_EQ(score_tracks(found, truth, 3).alpha, 1 - 3.5 / 6);
}

TEST(TrackScores, TheCorrectLinkFractionCountsSwitches) {
    Movie found = two_still();
    found[3].id[0] = 9;
    const TrackScores s = score_tracks(found, two_still(), 4);
    EXPECT_DOUBLE_EQ(s.correct_link_fraction(), 5.0 / 6);
}

TEST(TrackScores, OfNothingHaveNoValue) {
    EXPECT_TRUE(std::isnan(TrackScores{}.correct_link_fraction()));
    const TrackScores none = score_tracks(Movie(4), Movie(4), 4);
    for (const double value : {none.alpha, none.beta, none.jaccard_points, none.jaccard_tracks,
                               none.correct_link_fraction()}) {
        EXPECT_TRUE(std::isnan(value));
    }
    // Found where nothing is: no recall, but a Jaccard index of zero.
    const TrackScores false_only = score_tracks(two_still(), Movie(4), 4);
    EXPECT_TRUE(std::isnan(false_only.alpha));
    EXPECT_EQ(false_only.jaccard_points, 0);
    EXPECT_EQ(false_only.jaccard_tracks, 0);
}

/// α by its definition: every pairing of true tracks with found ones or with none.
double alpha_by_brute_force(const Movie& found, const Movie& truth, std::int64_t tracks,
                            double epsilon) {
    const auto position = [](const IdentifiedFrame& f, std::int64_t id) -> const Vec2* {
        const auto at = std::ranges::find(f.id, id);
        return at == f.id.end() ? nullptr
                                : &f.position[static_cast<std::size_t>(at - f.id.begin())];
    };
    const auto distance = [&](std::int64_t x, std::int64_t y) {
        double sum = 0;
        for (std::size_t f = 0; f < truth.size(); ++f) {
            const Vec2* a = position(truth[f], x);
            const Vec2* b = y < 0 ? nullptr : position(found[f], y);
            if (a != nullptr && b != nullptr) sum += std::min(epsilon, norm(*a - *b));
            if ((a == nullptr) != (b == nullptr)) sum += epsilon;
        }
        return sum;
    };
    // As many dummies as tracks: found tracks n … 2n − 1 do not exist.
    std::vector<std::int64_t> order(static_cast<std::size_t>(2 * tracks));
    std::iota(order.begin(), order.end(), 0);
    double least = 1e300;
    do {
        double sum = 0;
        for (std::int64_t x = 0; x < tracks; ++x) {
            const std::int64_t y = order[static_cast<std::size_t>(x)];
            sum += distance(x, y < tracks ? y : -1);
        }
        least = std::min(least, sum);
    } while (std::ranges::next_permutation(order).found);
    double nothing = 0;
    for (std::int64_t x = 0; x < tracks; ++x) nothing += distance(x, -1);
    return 1 - least / nothing;
}

TEST(TrackScores, AlphaIsTheLeastOverAllPairings) {
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        RandomStream random(seed, "tracks");
        Movie truth(5), found(5);
        for (std::size_t f = 0; f < 5; ++f) {
            for (std::int64_t i = 0; i < 4; ++i) {
                const Vec2 p{1.5 * static_cast<double>(i) + 0.3 * random.normal(),
                             0.3 * random.normal()};
                if (random.uniform() < 0.8) {
                    truth[f].id.push_back(i);
                    truth[f].position.push_back(p);
                }
                if (random.uniform() < 0.8) {
                    found[f].id.push_back((i + (random.uniform() < 0.2 ? 1 : 0)) % 4);
                    found[f].position.push_back(p + Vec2{0.4 * random.normal(), 0});
                    // Two found at once under one name: keep the first.
                    const auto last = found[f].id.back();
                    if (std::ranges::count(found[f].id, last) > 1) {
                        found[f].id.pop_back();
                        found[f].position.pop_back();
                    }
                }
            }
        }
        EXPECT_NEAR(score_tracks(found, truth, 2).alpha, alpha_by_brute_force(found, truth, 4, 2),
                    1e-12)
            << seed;
    }
}

}  // namespace
}  // namespace grainfield::tracking
