#include "tracking/refine/joint_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tests/tracking/refine/overlapping_discs.h"
#include "tracking/refine/disc_kernel.h"
#include "tracking/refine/joint_information.h"

namespace grainfield::tracking {
namespace {

TEST(JointFit, IsolatedDiscsReachTheCramerRaoBound) {
    const DiscProfile disc{16, 1.2};
    const auto truth = square_patch(32, 20, 20, 0.3);
    const Image darkness = darkness_of(truth, disc, 660, 0.02, 1);
    JointFit fit = started(darkness, truth, disc, 2, 0.5);
    RefinementOptions options;
    options.tolerance = 1e-4;
    EXPECT_EQ(fit.refine(options).unsettled, 0);
    const double bound = 0.02 * std::sqrt(6 * 1.2 / (std::numbers::pi * 16));
    // 800 coordinates: the RMS scatters by 2.5 %; ±4 σ.
    EXPECT_NEAR(rms(fit.positions(), truth) / bound, 1.0, 0.10);
}

TEST(JointFit, OverlappingDiscsReachTheJointBound) {
    const DiscProfile disc{16, 1.2};
    const auto truth = square_patch(0.80 * 16, 12, 20, 0.3);
    const double noise = 0.02;
    const Image darkness = darkness_of(truth, disc, 190, noise, 2);
    JointFit fit = started(darkness, truth, disc, 2, 0.5);
    RefinementOptions options;
    options.tolerance = 1e-5;
    options.max_sweeps = 2000;
    EXPECT_EQ(fit.refine(options).unsettled, 0);

    // The joint bound: all 288 coordinates unknown, information matrix from the exact model.
    const auto n = static_cast<Eigen::Index>(truth.size());
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    Eigen::VectorXd j(2 * n);
    for (int y = 0; y < 190; ++y) {
        for (int x = 0; x < 190; ++x) {
            j.setZero();
            double t = 1;
            for (const Vec2 c : truth) t *= 1 - disc.darkness(std::hypot(x - c.x, y - c.y));
            bool any = false;
            for (Eigen::Index i = 0; i < n; ++i) {
                const Vec2 c = truth[static_cast<std::size_t>(i)];
                const double r = std::hypot(x - c.x, y - c.y);
                if (r > disc.radius() + 5 * disc.edge_width) continue;
                const double g = t * 2 / disc.edge_width * disc.darkness(r) / std::max(r, 1e-9);
                j(2 * i) = g * (x - c.x);
                j(2 * i + 1) = g * (y - c.y);
                any = true;
            }
            if (any) information.selfadjointView<Eigen::Lower>().rankUpdate(j);
        }
    }
    const Eigen::MatrixXd full = information.selfadjointView<Eigen::Lower>();
    const double bound = noise * std::sqrt(full.inverse().trace() / (2.0 * static_cast<double>(n)));
    // 288 coordinates with unequal errors: the RMS scatters by about 6 %; 4 σ above the bound.
    EXPECT_LT(rms(fit.positions(), truth), 1.25 * bound);
    EXPECT_GT(rms(fit.positions(), truth), 0.75 * bound);
}

TEST(JointFit, TheResultDoesNotDependOnTheNumberOfThreads) {
    const DiscProfile disc{10, 1.2};
    const auto truth = square_patch(8, 30, 20, 0.3);
    const Image darkness = darkness_of(truth, disc, 280, 0.03, 3);
    JointFit one = started(darkness, truth, disc, 1, 0.5);
    JointFit eight = started(darkness, truth, disc, 8, 0.5);
    one.refine({});
    eight.refine({});
    EXPECT_EQ(one.positions(), eight.positions());
    EXPECT_EQ(one.transmission().inner(), eight.transmission().inner());
}

TEST(JointFit, RestingDiscsAreSkippedWithoutChangingTheResult) {
    const DiscProfile disc{10, 1.2};
    const auto truth = square_patch(16, 15, 20, 0.3);
    const Image darkness = darkness_of(truth, disc, 280, 0.02, 4);
    JointFit fit = started(darkness, truth, disc, 1, 0.5);
    const auto summary = fit.refine({});
    EXPECT_GT(summary.skipped, 0);
    JointFit exact = started(darkness, truth, disc, 1, 0.5);
    RefinementOptions strict;
    strict.tolerance = 1e-6;
    strict.max_sweeps = 500;
    exact.refine(strict);
    for (std::size_t i = 0; i < truth.size(); ++i) {
        EXPECT_LT(norm(fit.positions()[i] - exact.positions()[i]),
                  2 * RefinementOptions{}.tolerance);
    }
}

TEST(JointFit, RemovingADiscLeavesTheModelOfTheOthers) {
    const DiscProfile disc{10, 1.2};
    const std::vector<Vec2> centres{{20, 20}, {27, 21}, {50, 40}};
    const Image darkness = darkness_of(centres, disc, 64, 0, 5);
    JointFit fit(darkness, disc, 1);
    for (const Vec2 c : centres) fit.add(c);
    fit.keep_only({1, 0, 1});
    ASSERT_EQ(fit.positions().size(), 2u);
    JointFit fresh(darkness, disc, 1);
    fresh.add(centres[0]);
    fresh.add(centres[2]);
    const Image left = fit.transmission().inner();
    const Image expected = fresh.transmission().inner();
    for (std::size_t i = 0; i < darkness.size(); ++i) {
        EXPECT_NEAR(left.pixels()[i], expected.pixels()[i], 1e-5);
    }
}

TEST(JointFit, WhatADiscExplainsIsKnownAgainWhenItsNeighboursMove) {
    const DiscProfile disc{10, 1.2};
    const auto truth = square_patch(9, 12, 20, 0.3);
    const Image darkness = darkness_of(truth, disc, 140, 0.02, 7);
    JointFit fit = started(darkness, truth, disc, 1, 0.5);
    fit.explained();
    fit.refine({});
    std::vector<char> keep(truth.size(), 1);
    keep[60] = 0;
    fit.keep_only(keep);
    fit.refine({});
    const std::vector<double> kept = fit.explained();
    for (std::size_t j = 0; j < kept.size(); ++j) {
        const double fresh =
            explained_misfit(fit.darkness(), fit.transmission(), fit.positions()[j], disc);
        // What is kept may be as old as a path of 0.05 px.
        EXPECT_NEAR(kept[j], fresh, 0.02 * fresh);
    }
}

TEST(JointFit, OnlyDiscsNearThoseThatWentFarAreDisturbed) {
    const DiscProfile disc{10, 1.2};
    const auto truth = square_patch(12, 20, 20, 0.3);
    const Image darkness = darkness_of(truth, disc, 280, 0.02, 4);
    JointFit fit = started(darkness, truth, disc, 2, 0);
    const std::vector<Vec2> before = fit.positions();
    JointFit::Displacement all{std::vector<Vec2>(truth.size(), {0.02, 0}),
                               std::vector<float>(truth.size(), 0.0F)};
    EXPECT_EQ(fit.displace(all, 0.003, 0.1), 0);
    EXPECT_EQ(fit.collect_disturbed(), std::vector<char>(truth.size()));
    all.step[210] = {0.3, 0.4};
    EXPECT_GT(fit.displace(all, 0.003, 0.1), 0);
    const std::vector<char> disturbed = fit.collect_disturbed();
    EXPECT_EQ(fit.collect_disturbed(), std::vector<char>(truth.size())) << "asked for once";
    EXPECT_NEAR(norm(fit.positions()[210] - before[210]), JointFit::kLongestStep, 0.03);
    for (std::size_t j = 0; j < truth.size(); ++j) {
        const double distance = norm(truth[j] - truth[210]);
        EXPECT_TRUE(disturbed[j] || distance > 15) << j;
        EXPECT_TRUE(!disturbed[j] || distance < 17) << j;
    }
    // Too far for one step: it is swept, and who stands near it.
    RefinementOptions options;
    options.tolerance = 0.03;
    const JointFit::Summary again = fit.refine(options);
    EXPECT_GT(again.steps, 0);
    EXPECT_LT(again.steps, 60);
    const auto swept = fit.collect_disturbed();
    EXPECT_TRUE(swept[210]);
    EXPECT_LT(std::count(swept.begin(), swept.end(), 1), 120);
}

// In single precision half of all tolerances are rounded up.
TEST(JointFit, DiscsThatAreAToleranceAwayTakeNoStep) {
    const DiscProfile disc{10, 1.2};
    const auto truth = square_patch(14, 8, 20, 0.3);
    const Image darkness = darkness_of(truth, disc, 140, 0.02, 4);
    for (const double tolerance : {0.036, 0.0361, 0.0362, 0.0363}) {
        JointFit fit(darkness, disc, 1);
        fit.add_all(truth, {}, tolerance);
        RefinementOptions options;
        options.tolerance = tolerance;
        EXPECT_EQ(fit.refine(options).steps, 0) << tolerance;
    }
}

std::vector<Vec2> scattered(int width, int height, int n) {
    RandomStream random(31, "scattered");
    std::vector<Vec2> centres;
    for (int i = 0; i < n; ++i) {
        centres.push_back({random.uniform(-0.5, width - 0.5), random.uniform(-0.5, height - 0.5)});
    }
    return centres;
}

// Wide enough for several strips, high enough for many rows, and frames that hold one of each;
// sizes of which narrow rows of the window end farther to the right than wide ones.
TEST(JointFit, OnePassOverTheImageGivesWhatTwoGive) {
    for (const double diameter : {16.0, 14.0, 21.0}) {
        const DiscProfile disc{diameter, 1.2};
        for (const auto& [width, height] : {std::pair{900, 300}, {240, 700}, {30, 40}, {300, 20}}) {
            const auto centres = scattered(width, height, width * height / 250);
            const Image darkness(width, height, 0.4F);
            JointFit two(darkness, disc, 1);
            two.add_all(centres);
            const JointInformation expected = joint_information(two);
            std::optional<JointInformation> alone;
            for (const int threads : {1, 2, 8}) {
                JointFit fit(darkness, disc, threads);
                const JointInformation info = add_all(fit, centres, {}, {});
                ASSERT_EQ(info.begin, expected.begin) << width;
                for (std::size_t i = 0; i < centres.size(); ++i) {
                    // Discs are drawn in another order.
                    const double scale = 1e-3 * disc.information();
                    EXPECT_NEAR(info.own[i].xx, expected.own[i].xx, scale);
                    EXPECT_NEAR(info.own[i].yy, expected.own[i].yy, scale);
                    EXPECT_NEAR(info.own[i].bx, expected.own[i].bx, scale);
                    EXPECT_NEAR(info.own[i].by, expected.own[i].by, scale);
                    if (!alone) continue;
                    EXPECT_EQ(info.own[i].bx, alone->own[i].bx) << threads << " threads";
                    for (std::size_t e = info.begin[i]; e < info.begin[i + 1]; ++e) {
                        EXPECT_EQ(info.entry[e].other, alone->entry[e].other);
                        EXPECT_EQ(info.entry[e].block.xy, alone->entry[e].block.xy);
                    }
                }
                if (!alone) alone = info;
            }
        }
    }
}

TEST(JointFit, EveryDiscIsVisitedOnce) {
    const DiscProfile disc{14, 1.2};
    const auto centres = scattered(700, 400, 900);
    JointFit fit(Image(700, 400, 0.4F), disc, 2);
    std::vector<int> visits(centres.size());
    fit.add_all(centres, {}, {}, [&](int, const std::vector<std::uint32_t>& discs) {
        for (const std::uint32_t j : discs) ++visits[j];
    });
    EXPECT_EQ(visits, std::vector<int>(centres.size(), 1));
    EXPECT_THROW(fit.add_all(centres, {}, {}, [](int, const auto&) {}), std::logic_error);
}

TEST(JointFit, LocalResidualsAreThoseWithinReach) {
    const DiscProfile disc{16, 1.2};
    const auto truth = square_patch(15, 6, 3, 0.5);
    const Image darkness = darkness_of(truth, disc, 90, 0.05, 6);
    for (const bool is_masked : {false, true}) {
        Image mask(90, 90, 1);
        for (int i = 0; is_masked && i < 90; ++i) {
            for (int j = 30; j < 40; ++j) mask(i, j) = 0;
        }
        JointFit fit(darkness, disc, 2);
        const VisiblePixels visible(mask);
        fit.set_visible(visible);
        fit.restart(darkness);
        fit.add_all(truth);
        const JointFit::Residuals residuals = fit.residuals();
        for (std::size_t j = 0; j < truth.size(); ++j) {
            double sum = 0;
            double n = 0;
            double at_edge = 0;
            double edge = 0;
            double edge2 = 0;
            for (int y = 0; y < 90; ++y) {
                for (int x = 0; x < 90; ++x) {
                    const Vec2 p = fit.positions()[j];
                    const double from_centre = std::hypot(x - p.x, y - p.y);
                    if (from_centre > disc.reach()) continue;
                    if (!visible(x, y)) continue;
                    const auto t = static_cast<double>(fit.transmission()(x, y));
                    const double r = static_cast<double>(fit.darkness()(x, y)) - 1 + t;
                    sum += r * r;
                    n += 1;
                    // |∂T/∂r|², of a disc whose t is the tanh edge.
                    const double slope =
                        t / (1 - disc.darkness(from_centre)) * disc.slope(from_centre);
                    at_edge += slope * slope * r * r;
                    edge += slope * slope;
                    edge2 += std::pow(slope, 4);
                }
            }
            EXPECT_NEAR(residuals.within_reach[j], std::sqrt(sum / n), 1e-5) << j;
            EXPECT_NEAR(residuals.at_edge[j], std::sqrt(at_edge / edge), 0.002) << j;
            EXPECT_NEAR(residuals.edge_pixels[j] / (edge * edge / edge2), 1, 0.05) << j;
        }
    }
}

TEST(JointFit, GoesOnWithTheSameDiscsOnAnotherImage) {
    const DiscProfile disc{12, 1.4};
    std::vector<Vec2> centres = square_patch(10, 5, 20, 0.2);
    const Image before = darkness_of(centres, disc, 80, 0.01, 3);
    for (Vec2& c : centres) c += Vec2{0.15, -0.1};
    const Image after = darkness_of(centres, disc, 80, 0.01, 4);

    JointFit goes_on = started(before, centres, disc, 2, 0.3);
    goes_on.refine({}, Drawing::exactly);
    const std::vector<Vec2> settled = goes_on.positions();
    const std::uint64_t arrangement = goes_on.arrangement();
    goes_on.look_at(after, 0.5);
    EXPECT_NE(goes_on.arrangement(), arrangement) << "sums of the other image no longer hold";
    EXPECT_EQ(goes_on.positions(), settled);
    goes_on.refine({}, Drawing::exactly);

    JointFit anew(after, disc, 2);
    anew.add_all(settled, {}, 0.5);
    anew.refine({}, Drawing::exactly);
    // Both rest where a step is below the tolerance, 0.003 px.
    EXPECT_LT(rms(goes_on.positions(), anew.positions()), 3e-3);
    EXPECT_LT(rms(goes_on.positions(), centres), 0.02);
    EXPECT_NEAR(goes_on.residual_rms(), anew.residual_rms(), 1e-5);
    const std::vector<double> explained = anew.explained();
    for (std::size_t j = 0; j < explained.size(); ++j) {
        EXPECT_NEAR(goes_on.explained()[j], explained[j], 1e-2 * explained[j]);
    }
}

}  // namespace
}  // namespace grainfield::tracking
