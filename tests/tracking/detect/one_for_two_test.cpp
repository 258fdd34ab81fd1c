#include "tracking/detect/one_for_two.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tracking/refine/disc_kernel.h"

namespace grainfield::tracking {
namespace {

constexpr int kSize = 260;
constexpr double kA = 16;
constexpr double kNoise = 0.02;
constexpr DiscProfile kDisc{14, 1.6};
constexpr SphereCell kCell{.diameter = kA, .height = 1.94};
const RefinementOptions kSweeps{.tolerance = 0.03, .max_sweeps = 30};

BiasCorrection no_bias() {
    BiasCorrection correction;
    correction.diameter = kA;
    correction.weights.assign(BiasTerms::kCount, 0.0);
    return correction;
}

Image frame_of(const std::vector<Vec2>& discs) {
    PaddedImage transmission = clear_transmission(kSize, kSize, kDisc);
    place_discs(transmission, discs, kDisc);
    Image darkness(kSize, kSize);
    RandomStream random(7, "one for two");
    for (int y = 0; y < kSize; ++y) {
        for (int x = 0; x < kSize; ++x) {
            darkness(x, y) =
                1.0F - transmission.row(y)[x] + static_cast<float>(kNoise * random.normal());
        }
    }
    return darkness;
}

constexpr int kRow = 13;
constexpr int kMiddleRow = kRow / 2;
constexpr double kSpacing = 0.76 * kA;
constexpr double kFirst = 55;

/// Two layers in projection: neighbours in a row belong to different ones, and have room.
std::vector<Vec2> crystal() {
    std::vector<Vec2> discs;
    for (int row = 0; row < kRow; ++row) {
        for (int column = 0; column < kRow; ++column) {
            discs.push_back({kFirst + kSpacing * column, kFirst + kSpacing * row});
        }
    }
    return discs;
}

/// In each of these rows six discs stand in the place of five.
std::vector<Vec2> with_one_too_many(const std::vector<int>& rows = {kMiddleRow}) {
    std::vector<Vec2> discs = crystal();
    for (const int row : rows) {
        const double y = kFirst + kSpacing * row;
        discs.erase(std::remove_if(discs.begin(), discs.end(),
                                   [&](Vec2 p) {
                                       const double place = (p.x - kFirst) / kSpacing;
                                       return std::abs(p.y - y) < 1 && place > 3.5 && place < 8.5;
                                   }),
                    discs.end());
        for (int k = 0; k < 6; ++k) discs.push_back({kFirst + kSpacing * (4 + 0.8 * k), y});
    }
    return discs;
}

double farthest(const std::vector<Vec2>& points, const std::vector<Vec2>& from) {
    double most = 0;
    for (const Vec2 p : points) {
        double least = std::numeric_limits<double>::infinity();
        for (const Vec2 q : from) least = std::min(least, norm(p - q));
        most = std::max(most, least);
    }
    return most;
}

struct Tried {
    OneForTwo summary;
    std::vector<Vec2> before, after;
};

Tried tried(const std::vector<Vec2>& shown, const std::vector<Vec2>& discs, int threads = 2) {
    const Image darkness = frame_of(shown);
    JointFit fit(darkness, kDisc, threads);
    fit.restart(darkness);
    fit.add_all(discs);
    fit.refine({.tolerance = 0.003, .max_sweeps = 150});
    Tried result;
    result.before = fit.positions();
    result.summary = try_one_for_two(fit, kCell, no_bias(), kNoise, kSweeps);
    fit.refine({.tolerance = 0.003, .max_sweeps = 150});
    result.after = fit.positions();
    return result;
}

TEST(OneForTwo, MendsARowWithOneTooMany) {
    const std::vector<Vec2> shown = crystal();
    const Tried mended = tried(shown, with_one_too_many());
    EXPECT_EQ(mended.before.size(), shown.size() + 1);
    EXPECT_EQ(mended.summary.kept, 1);
    ASSERT_EQ(mended.after.size(), shown.size());
    EXPECT_LT(farthest(shown, mended.after), 0.02 * kA);
}

TEST(OneForTwo, MendsRowsInTheSameRoundThatAreFarApart) {
    const std::vector<Vec2> shown = crystal();
    const Tried mended = tried(shown, with_one_too_many({1, kRow - 2}));
    EXPECT_EQ(mended.before.size(), shown.size() + 2);
    EXPECT_EQ(mended.summary.kept, 2);
    EXPECT_LT(mended.summary.rounds, mended.summary.trials);
    ASSERT_EQ(mended.after.size(), shown.size());
    EXPECT_LT(farthest(shown, mended.after), 0.02 * kA);
}

TEST(OneForTwo, MendsARowBesideOneThatThePictureShows) {
    const std::vector<Vec2> shown = with_one_too_many({1});
    const Tried mended = tried(shown, with_one_too_many({1, kRow - 2}));
    EXPECT_EQ(mended.before.size(), shown.size() + 1);
    EXPECT_GT(mended.summary.trials, mended.summary.kept);
    EXPECT_EQ(mended.summary.kept, 1);
    ASSERT_EQ(mended.after.size(), shown.size());
    EXPECT_LT(farthest(shown, mended.after), 0.05 * kA);
}

TEST(OneForTwo, TriesNothingWhereAllHaveRoom) {
    const Tried right = tried(crystal(), crystal());
    EXPECT_EQ(right.summary.trials, 0);
    EXPECT_EQ(right.summary.steps, 0);
    EXPECT_EQ(right.after.size(), right.before.size());
}

TEST(OneForTwo, LeavesDiscsThatThePictureShows) {
    // Each three of these have no room, yet all are seen.
    std::vector<Vec2> shown;
    for (int k = 0; k < 5; ++k) {
        shown.push_back({100 + 0.6 * kA * k, 120});
        shown.push_back({100 + 0.6 * kA * (k + 0.5), 120 + 0.52 * kA});
    }
    const Tried left = tried(shown, shown);
    EXPECT_GT(left.summary.trials, 0);
    EXPECT_EQ(left.summary.kept, 0);
    ASSERT_EQ(left.after.size(), shown.size());
    EXPECT_LT(farthest(left.before, left.after), 0.05);
    EXPECT_LT(farthest(shown, left.after), 0.02 * kA);
}

TEST(OneForTwo, DoesNotDependOnTheNumberOfThreads) {
    const Tried one = tried(crystal(), with_one_too_many(), 1);
    const Tried two = tried(crystal(), with_one_too_many(), 2);
    EXPECT_EQ(one.summary.steps, two.summary.steps);
    ASSERT_EQ(one.after.size(), two.after.size());
    for (std::size_t j = 0; j < one.after.size(); ++j) {
        EXPECT_EQ(one.after[j].x, two.after[j].x);
        EXPECT_EQ(one.after[j].y, two.after[j].y);
    }
}

}  // namespace
}  // namespace grainfield::tracking
