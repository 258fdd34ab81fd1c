#include "tracking/refine/joint_covariance.h"

#include <cmath>
#include <numbers>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::tracking {
namespace {

/// A fit whose discs stand on a jittered square lattice; the image does not matter.
JointFit lattice(double spacing, int side, const DiscProfile& disc, int threads = 2) {
    const int size = static_cast<int>(spacing * side + 2 * disc.diameter);
    JointFit fit(Image(size, size), disc, threads);
    RandomStream random(11, "lattice");
    for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) {
            fit.add({disc.diameter + spacing * i + 0.4 * random.normal(),
                     disc.diameter + spacing * j + 0.4 * random.normal()});
        }
    }
    return fit;
}

/// The inverse of the whole information matrix, pixel by pixel in double precision.
Eigen::MatrixXd oracle(const JointFit& fit) {
    const auto& centres = fit.positions();
    const DiscProfile& disc = fit.disc();
    const auto n = static_cast<Eigen::Index>(centres.size());
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    for (int y = 0; y < fit.darkness().height(); ++y) {
        for (int x = 0; x < fit.darkness().width(); ++x) {
            const auto t = static_cast<double>(fit.transmission()(x, y));
            std::vector<std::pair<Eigen::Index, Vec2>> touched;
            for (Eigen::Index i = 0; i < n; ++i) {
                const Vec2 d = Vec2{static_cast<double>(x), static_cast<double>(y)} -
                               centres[static_cast<std::size_t>(i)];
                const double r = norm(d);
                if (r >= disc.reach()) continue;
                touched.emplace_back(
                    i, (t * 2 / disc.edge_width * disc.darkness(r) / std::max(r, 1e-9)) * d);
            }
            for (const auto& [i, ji] : touched) {
                for (const auto& [k, jk] : touched) {
                    information(2 * i, 2 * k) += ji.x * jk.x;
                    information(2 * i, 2 * k + 1) += ji.x * jk.y;
                    information(2 * i + 1, 2 * k) += ji.y * jk.x;
                    information(2 * i + 1, 2 * k + 1) += ji.y * jk.y;
                }
            }
        }
    }
    return information.inverse();
}

void expect_inverse(const JointFit& fit, double tolerance) {
    const auto covariance = joint_covariance(joint_information(fit), 2);
    const Eigen::MatrixXd exact = oracle(fit);
    for (std::size_t j = 0; j < covariance.size(); ++j) {
        const auto i = static_cast<Eigen::Index>(2 * j);
        const double scale = exact(i, i) + exact(i + 1, i + 1);
        EXPECT_NEAR(covariance[j].xx, exact(i, i), tolerance * scale) << j;
        EXPECT_NEAR(covariance[j].yy, exact(i + 1, i + 1), tolerance * scale) << j;
        EXPECT_NEAR(covariance[j].xy, exact(i, i + 1), tolerance * scale) << j;
    }
}

TEST(JointCovariance, OfIsolatedDiscsIsTheClosedForm) {
    const DiscProfile disc{16, 1.2};
    const double bound = 6 * 1.2 / (std::numbers::pi * 16);
    for (const PositionCovariance& c :
         joint_covariance(joint_information(lattice(32, 6, disc)), 1)) {
        EXPECT_NEAR(c.xx, bound, 0.05 * bound);
        EXPECT_NEAR(c.yy, bound, 0.05 * bound);
    }
}

TEST(JointCovariance, EqualsTheInverseOfTheWholeInformationInALiquid) {
    expect_inverse(lattice(16.5, 8, {16, 1.2}), 0.02);
}

// Shells do not converge here; the sparse factor takes over. Variances, so twice the error.
TEST(JointCovariance, EqualsTheInverseOfTheWholeInformationInACrystal) {
    expect_inverse(lattice(0.80 * 16, 10, {16, 1.2}), 0.06);
}

TEST(JointCovariance, DoesNotDependOnTheNumberOfThreads) {
    const JointFit fit = lattice(0.82 * 12, 14, {12, 1.2});
    const auto one = joint_covariance(joint_information(fit), 1);
    const auto eight = joint_covariance(joint_information(fit), 8);
    for (std::size_t j = 0; j < one.size(); ++j) {
        EXPECT_EQ(one[j].xx, eight[j].xx);
        EXPECT_EQ(one[j].xy, eight[j].xy);
    }
}

TEST(JointCovariance, OfAHiddenDiscIsNotANumber) {
    const DiscProfile disc{12, 0.5};
    JointFit fit(Image(64, 64), disc, 1);
    for (int i = 0; i < 6; ++i) fit.add({32, 32});
    fit.add({10, 10});
    const auto covariance = joint_covariance(joint_information(fit), 1);
    EXPECT_TRUE(std::isnan(covariance[0].xx));
    EXPECT_GT(covariance[6].xx, 0);
}

}  // namespace
}  // namespace grainfield::tracking
