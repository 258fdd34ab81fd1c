#include "tracking/refine/joint_information.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/tracking/refine/overlapping_discs.h"
#include "tracking/refine/joint_covariance.h"

namespace grainfield::tracking {
namespace {

TEST(JointStep, SolvesTheNormalEquationsOfAllPositions) {
    const DiscProfile disc{16, 1.2};
    const auto truth = square_patch(0.80 * 16, 8, 20, 0.3);
    const Image darkness = darkness_of(truth, disc, 140, 0.02, 8);
    const JointFit fit = swept(darkness, truth, disc);
    const JointInformation info = joint_information(fit);
    const auto n = static_cast<Eigen::Index>(truth.size());
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    Eigen::VectorXd right(2 * n);
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const auto row = static_cast<Eigen::Index>(2 * i);
        const NormalEquations& own = info.own[i];
        const double damping = 1e-3 * (own.xx + own.yy) + 1e-3;
        matrix.block<2, 2>(row, row) << own.xx + damping, own.xy, own.xy, own.yy + damping;
        right.segment<2>(row) << own.bx, own.by;
        for (std::size_t e = info.begin[i]; e < info.begin[i + 1]; ++e) {
            const CrossBlock& b = info.entry[e].block;
            matrix.block<2, 2>(row, 2 * static_cast<Eigen::Index>(info.entry[e].other)) << b.xx,
                b.xy, b.yx, b.yy;
        }
    }
    const Eigen::VectorXd exact = matrix.ldlt().solve(right);
    const auto joint = joint_step(info, 1e-6);
    for (Eigen::Index i = 0; i < n; ++i) {
        EXPECT_NEAR(joint.step[static_cast<std::size_t>(i)].x, exact(2 * i), 1e-5) << i;
        EXPECT_NEAR(joint.step[static_cast<std::size_t>(i)].y, exact(2 * i + 1), 1e-5) << i;
    }
}

// What takes dozens of sweeps in a crystal.
TEST(JointStep, GoesWhereSweepsEnd) {
    const DiscProfile disc{16, 1.2};
    const auto truth = square_patch(0.80 * 16, 12, 20, 0.3);
    const Image darkness = darkness_of(truth, disc, 190, 0.02, 2);
    JointFit exact = started(darkness, truth, disc, 2, 0.5);
    RefinementOptions strict;
    strict.tolerance = 1e-5;
    strict.max_sweeps = 2000;
    exact.refine(strict);
    JointFit fit = swept(darkness, truth, disc);
    // Sweeps alone stop too early here.
    const double before = rms(fit.positions(), exact.positions());
    for (int round = 0; round < 3; ++round) {
        fit.displace(joint_step(joint_information(fit), 1e-4), 0.003, 0.1);
    }
    double variance = 0;
    const auto covariance = joint_covariance(joint_information(fit), 2);
    for (const PositionCovariance& c : covariance) variance += 0.5 * (c.xx + c.yy);
    const double error = 0.02 * std::sqrt(variance / static_cast<double>(truth.size()));
    EXPECT_GT(before, 0.25 * error);
    // An eighth of the error, .025 px, is what steps of .003 px that are not drawn leave; the last
    // digits differ between processors (vectors of 8 or 16).
    EXPECT_LT(rms(fit.positions(), exact.positions()), 0.14 * error);
}

/// As the Locator settles; one disc is far off and swept in between.
std::vector<Vec2> settled(const Image& darkness, const std::vector<Vec2>& places,
                          const DiscProfile& disc, double least_drawn) {
    RefinementOptions rough;
    rough.tolerance = 0.036;
    JointFit fit = started(darkness, places, disc, 2, 0.02);
    fit.move(90, places[90] + Vec2{0.34, 0});
    JointInformation information;
    bool is_far = true;
    for (int round = 0; round < 4 && is_far; ++round) {
        if (round > 0) fit.refine(rough, Drawing::roughly);
        const std::vector<char> disturbed = fit.collect_disturbed();
        if (round == 0) {
            information = joint_information(fit);
        } else {
            update_information(fit, disturbed, information);
        }
        is_far = fit.displace(joint_step(information, 1e-4), least_drawn, 0.096, round > 0) > 0;
        EXPECT_TRUE(is_far || round > 0);
    }
    return fit.positions();
}

// Nor does it take back the steps that its neighbours have made with all others.
TEST(JointStep, WhatIsNotDrawnStaysWhereADiscIsSweptInBetween) {
    const DiscProfile disc{16, 1.2};
    for (const auto& [spacing, noise] : {std::pair{1.0, 0.02}, {0.9, 0.05}, {1.0, 0.005}}) {
        const auto truth = square_patch(spacing * 16, 14, 20, 0.3);
        const Image darkness = darkness_of(truth, disc, 256, noise, 9);
        JointFit exact = started(darkness, truth, disc, 2, 0.2);
        RefinementOptions strict;
        strict.tolerance = 1e-5;
        strict.max_sweeps = 2000;
        exact.refine(strict);
        const auto drawn = settled(darkness, exact.positions(), disc, 0);
        const auto waiting = settled(darkness, exact.positions(), disc, 0.06);
        // Sweeps leave discs beside where they would rest, and one joint step from there is right
        // to second order.
        const double error = noise / std::sqrt(disc.information());
        for (std::size_t j = 0; j < truth.size(); ++j) {
            EXPECT_LT(norm(waiting[j] - drawn[j]), std::max(0.001, 0.15 * error))
                << j << " at " << spacing << " D, noise " << noise;
        }
    }
}

// Which steps are drawn saves time and decides nothing.
TEST(JointStep, StepsThatAreNotDrawnAreKnownInResiduals) {
    const DiscProfile disc{16, 1.2};
    for (const double noise : {0.02, 0.005}) {
        const auto truth = square_patch(0.9 * 16, 14, 20, 0.3);
        const Image darkness = darkness_of(truth, disc, 240, noise, 9);
        JointFit drawn = swept(darkness, truth, disc);
        JointFit waiting = swept(darkness, truth, disc);
        const JointInformation information = joint_information(drawn);
        const auto first = joint_step(information, 1e-4);
        drawn.displace(first, 0, 0.1);
        waiting.displace(first, 3 * noise, 0.1);
        EXPECT_EQ(drawn.positions(), waiting.positions());
        const auto gain = pending_gain(waiting, information);
        const auto exact = drawn.residuals();
        const auto known = waiting.residuals(gain);
        for (std::size_t j = 0; j < truth.size(); ++j) {
            EXPECT_NEAR(known.within_reach[j] / exact.within_reach[j], 1, 0.04)
                << j << ", noise " << noise;
            EXPECT_NEAR(known.at_edge[j] / exact.at_edge[j], 1, 0.15) << j << ", noise " << noise;
        }
        EXPECT_NEAR(waiting.residual_rms(gain) / drawn.residual_rms(), 1, 0.002);
        // Steps of second order are left, whichever discs are drawn.
        const auto again = joint_step(joint_information(waiting), 1e-4);
        for (std::size_t j = 0; j < truth.size(); ++j) {
            EXPECT_LT(norm(again.step[j] - waiting.pending_step(j)), 0.004) << j;
        }
        waiting.draw_pending();
        for (std::size_t j = 0; j < truth.size(); ++j) EXPECT_EQ(waiting.pending_step(j), Vec2{});
    }
}

}  // namespace
}  // namespace grainfield::tracking
