#include "tracking/refine/joint_solver.h"

#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::tracking {
namespace {

constexpr DiscProfile kDisc{16, 1.2};
constexpr int kSide = 12;
constexpr JointSolver::StepLimits kLimits{.accuracy = 1e-5, .least_drawn = 1e-5, .far = 0.1};

/// Discs of a square patch, two of three of which overlap their neighbours.
std::vector<Vec2> patch() {
    RandomStream random(5, "solver patch");
    std::vector<Vec2> centres;
    for (int i = 0; i < kSide; ++i) {
        for (int j = 0; j < kSide; ++j) {
            centres.push_back(
                {20 + 14.0 * i + 0.5 * random.normal(), 20 + 14.0 * j + 0.5 * random.normal()});
        }
    }
    return centres;
}

Image darkness_of(const std::vector<Vec2>& centres) {
    Image image(200, 200);
    for (int y = 0; y < 200; ++y) {
        for (int x = 0; x < 200; ++x) {
            double t = 1;
            for (const Vec2 c : centres) t *= 1 - kDisc.darkness(norm(Vec2{x - c.x, y - c.y}));
            image(x, y) = static_cast<float>(1 - t);
        }
    }
    return image;
}

/// A patch on which a first joint step has been taken.
struct Stepped {
    std::vector<Vec2> truth = patch();
    JointFit fit{darkness_of(truth), kDisc, 1};
    JointSolver solver;

    explicit Stepped(double off) {
        RandomStream random(7, "solver start");
        std::vector<Vec2> start = truth;
        for (Vec2& p : start) p += off * Vec2{random.normal(), random.normal()};
        solver.place_all(fit, start, {}, {});
        solver.step(fit, kLimits, true);
    }
    std::int64_t all() const { return static_cast<std::int64_t>(truth.size()); }
};

TEST(JointSolver, AStepAfterWhichFewGoFarIsAnUpdateOfTheseAlone) {
    Stepped s(0.02);
    s.solver.step(s.fit, kLimits, false);
    s.fit.move(0, s.truth[0] + Vec2{0.15, 0});
    s.solver.step(s.fit, kLimits, true);  // a disc was put elsewhere: all sums anew
    const JointSolver::StepCount step = s.solver.step(s.fit, kLimits, false);
    EXPECT_LT(step.discs, s.all() / 2);
}

// Couplings of before, where the discs were, do not make a positive matrix.
TEST(JointSolver, WhereMostDiscsAreDisturbedAllIsSummedAnew) {
    Stepped s(0.6);
    const JointSolver::StepCount step = s.solver.step(s.fit, kLimits, false);
    EXPECT_EQ(step.discs, s.all());
}

TEST(JointSolver, WhereADiscWasPutElsewhereAllIsSummedAnew) {
    Stepped s(0.02);
    s.solver.step(s.fit, kLimits, false);
    s.fit.move(0, s.truth[0] + Vec2{0.15, 0});
    EXPECT_EQ(s.solver.step(s.fit, kLimits, false).discs, s.all());
}

TEST(JointSolver, StepsFromHalfAPixelAwayEndAtTheTruth) {
    Stepped s(0.5);
    for (int k = 0; k < 30; ++k) s.solver.step(s.fit, kLimits, false);
    double worst = 0;
    for (std::size_t j = 0; j < s.truth.size(); ++j) {
        worst = std::max(worst, norm(s.fit.positions()[j] - s.truth[j]));
    }
    EXPECT_LT(worst, 5e-3);  // the kernel cuts edges off at its reach
}

}  // namespace
}  // namespace grainfield::tracking
