#include "tracking/refine/edge_residuals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::tracking {
namespace {

constexpr double kPixels = 50;

/// Edges whose misfits [contrast²] have this mean and relative spread, seen through white noise.
struct Edges {
    std::vector<double> misfit;
    JointFit::Residuals left;
};

Edges edges(std::size_t count, double noise, double mean, double spread) {
    RandomStream random(1, "edges");
    Edges e;
    for (std::size_t j = 0; j < count; ++j) {
        const double misfit = mean * std::max(0.0, 1 + spread * random.normal());
        // Each pixel: a misfit of random sign beside the noise.
        double sum = 0;
        for (int p = 0; p < static_cast<int>(kPixels); ++p) {
            const double sign = random.uniform(0, 1) < 0.5 ? -1 : 1;
            sum += std::pow(noise * random.normal() + sign * std::sqrt(misfit), 2);
        }
        e.misfit.push_back(misfit);
        e.left.at_edge.push_back(std::sqrt(sum / kPixels));
        e.left.within_reach.push_back(0.5);
        e.left.edge_pixels.push_back(kPixels);
    }
    return e;
}

std::vector<EdgeKind> alike(const JointFit::Residuals& left) {
    return std::vector<EdgeKind>(left.at_edge.size(), EdgeKind::meeting);
}

/// RMS error of the misfit that values say [contrast²].
double error(const std::vector<double>& values, const Edges& e, double noise) {
    double sum = 0;
    for (std::size_t j = 0; j < values.size(); ++j) {
        sum += std::pow(values[j] * values[j] - noise * noise - e.misfit[j], 2);
    }
    return std::sqrt(sum / static_cast<double>(values.size()));
}

TEST(EdgeResiduals, OfFramesOfLittleNoiseStayAsTheyAre) {
    const Edges e = edges(500, 0.001, 0.0016, 0.2);
    const std::vector<double> steadied = edge_residuals(e.left, alike(e.left), 0.001);
    for (std::size_t j = 0; j < steadied.size(); ++j) {
        EXPECT_NEAR(steadied[j] / e.left.at_edge[j], 1, 0.02) << j;
    }
}

TEST(EdgeResiduals, AreNearerToTheMisfitWhereNoiseIsLarge) {
    for (const double spread : {0.0, 0.25, 0.5}) {
        const Edges e = edges(2000, 0.05, 0.0009, spread);
        const double raw = error(e.left.at_edge, e, 0.05);
        EXPECT_LT(error(edge_residuals(e.left, alike(e.left), 0.05), e, 0.05), 0.65 * raw)
            << spread;
    }
}

TEST(EdgeResiduals, OfTheRightModelAreTheNoise) {
    const Edges e = edges(2000, 0.02, 0, 0);
    for (const double rms : edge_residuals(e.left, alike(e.left), 0.02))
        EXPECT_NEAR(rms, 0.02, 0.001);
}

// All edges have as many pixels.
TEST(EdgeResiduals, KeepTheirMean) {
    const Edges e = edges(2000, 0.03, 0.0009, 0.3);
    const std::vector<double> steadied = edge_residuals(e.left, alike(e.left), 0.03);
    const auto mean_square = [](const std::vector<double>& v) {
        return std::inner_product(v.begin(), v.end(), v.begin(), 0.0) /
               static_cast<double>(v.size());
    };
    EXPECT_NEAR(mean_square(steadied) / mean_square(e.left.at_edge), 1, 1e-9);
}

TEST(EdgeResiduals, OneSpeckOfDustDoesNotRaiseTheOthers) {
    Edges e = edges(400, 0.03, 0.0009, 0.3);
    const std::vector<double> before = edge_residuals(e.left, alike(e.left), 0.03);
    e.left.at_edge[7] = 0.6;
    const std::vector<double> after = edge_residuals(e.left, alike(e.left), 0.03);
    for (std::size_t j = 0; j < after.size(); ++j) {
        if (j == 7) continue;
        EXPECT_NEAR(after[j] / before[j], 1, 0.01) << j;
    }
}

TEST(EdgeResiduals, WithoutPixelsAreWhatIsLeftWithinReachOrTheNoise) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const JointFit::Residuals left{{0.2, kNone}, {kNone, kNone}, {0, 0}};
    EXPECT_EQ(edge_residuals(left, alike(left), 0.01), (std::vector<double>{0.2, 0.01}));
    EXPECT_TRUE(edge_residuals({}, {}, 0.01).empty());
}

// A dilute layer: most spheres as the model has them, some overlaps that it describes badly.
TEST(EdgeResiduals, OfSpheresAloneAreNoiseWhateverOverlapsLeave) {
    constexpr double kNoise = 0.02;
    Edges e = edges(400, kNoise, 0, 0);
    const Edges overlaps = edges(60, kNoise, 0.0025, 0.2);
    std::vector<EdgeKind> kinds(460, EdgeKind::meeting);
    std::fill_n(kinds.begin(), 400, EdgeKind::alone);
    e.left.at_edge.insert(e.left.at_edge.end(), overlaps.left.at_edge.begin(),
                          overlaps.left.at_edge.end());
    e.left.within_reach.resize(460, 0.5);
    e.left.edge_pixels.resize(460, kPixels);
    const std::vector<double> steadied = edge_residuals(e.left, kinds, kNoise);
    for (std::size_t j = 0; j < 400; ++j) EXPECT_NEAR(steadied[j], kNoise, 0.1 * kNoise) << j;
    double mean = 0;
    for (std::size_t j = 400; j < 460; ++j) mean += steadied[j] * steadied[j] / 60;
    EXPECT_NEAR(mean - kNoise * kNoise, 0.0025, 0.0003);
}

TEST(EdgeResiduals, AreAloneWhereNoOtherEdgeIsMet) {
    const DiscProfile disc{10, 1};
    const double meet = 2 * disc.edge_reach();
    const std::vector<Vec2> discs{{20, 20},       {25, 20}, {60, 20},
                                  {60 + 9.5, 20}, {20, 60}, {20 + meet + 0.1, 60}};
    EXPECT_EQ(edge_kinds(discs, disc, 100, 100),
              (std::vector<EdgeKind>{EdgeKind::meeting, EdgeKind::meeting, EdgeKind::meeting,
                                     EdgeKind::meeting, EdgeKind::alone, EdgeKind::alone}));
}

}  // namespace
}  // namespace grainfield::tracking
