// S(k) of point processes with closed forms. |ρ_k|²/N of one mode in one frame is exponentially
// distributed around S for many particles, so that the mean over M of them has a gamma
// distribution: for M ≥ 1000 a deviation of 6 S/sqrt(M) has p < 1e-8, and below 1e-6 for all shells
// of a test together.

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "analysis/spectra/structure_factor.h"
#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;
using Make = std::function<std::vector<Vec2>(RandomStream&)>;

ObservableResult measure(const Box& box, const StructureFactorOptions& options, int frames,
                         const char* name, const Make& make) {
    StructureFactor sk(options, box, frames);
    for (int f = 0; f < frames; ++f) {
        RandomStream random(7, name, static_cast<std::uint64_t>(f));
        sk.add(sk.measure(pattern(make(random), box, f)));
    }
    return sk.result();
}

// `sharing`: how many modes of the grid share the information of one independent mode.
void expect_curve(const ObservableResult& result, const char* curve_name, int frames,
                  double sharing, const std::function<double(double)>& truth) {
    const Curve* curve = result.find_curve(curve_name);
    ASSERT_NE(curve, nullptr);
    int tested = 0;
    for (std::size_t i = 0; i < curve->find("k")->values.size(); ++i) {
        const double modes = curve->find("n")->values[i] * frames / sharing;
        if (modes < 1000) continue;
        const double wanted = truth(curve->find("k")->values[i]);
        EXPECT_NEAR(curve->find("s")->values[i], wanted, 6 * wanted / std::sqrt(modes))
            << "k = " << curve->find("k")->values[i];
        ++tested;
    }
    EXPECT_GE(tested, 5);
}

TEST(StructureFactorTheory, OfAPoissonPatternIsOne) {
    const Box box = square_box(20);
    const auto result = measure(box, {.k_max = 6}, 600, "poisson", [&](RandomStream& random) {
        return poisson_points(400, box, random);
    });
    expect_curve(result, "sk", 600, 1, [](double) { return 1.0; });
}

TEST(StructureFactorTheory, OfAPerfectLatticeVanishesTo1e18OffBragg) {
    const auto result =
        measure(square_box(100), {.k_max = 2}, 1, "lattice",
                [](RandomStream& random) { return square_lattice(100, 1, 0, random); });
    for (double s : result.find_curve("sk")->find("s")->values) EXPECT_LT(s, 1e-18);
}

TEST(StructureFactorTheory, OfAJitteredLatticeIsOneMinusTheDebyeWallerFactor) {
    const double sigma = 0.2;
    const auto result = measure(square_box(20), {.k_max = 5}, 600, "jitter",
                                [&](RandomStream& r) { return square_lattice(20, 1, sigma, r); });
    const Curve* curve = result.find_curve("sk");
    int tested = 0;
    for (std::size_t i = 0; i < curve->find("k")->values.size(); ++i) {
        const double k = curve->find("k")->values[i];
        const double modes = curve->find("n")->values[i] * 600;
        if (modes < 1000) continue;
        // The mean over a shell up to half a grid step wide on both sides bends with S(k).
        const double wanted = 1 - std::exp(-k * k * sigma * sigma);
        const double bend = k < 5.5 * 2 * std::numbers::pi / 20 ? 0 : 0.005;
        EXPECT_NEAR(curve->find("s")->values[i], wanted, 6 * wanted / std::sqrt(modes) + bend);
        ++tested;
    }
    EXPECT_GE(tested, 10);
}

TEST(StructureFactorTheory, OfAThinnedPatternIsPSPlusOneMinusP) {
    const double p = 0.95;
    const auto result = measure(square_box(20), {.k_max = 1.6}, 1000, "thin", [&](RandomStream& r) {
        std::vector<Vec2> points = square_lattice(20, 1, 0.2, r);
        std::erase_if(points, [&](Vec2) { return r.uniform() > p; });
        return points;
    });
    expect_curve(result, "sk", 1000, 1,
                 [&](double k) { return p * (1 - std::exp(-k * k * 0.04)) + 1 - p; });
}

// Independent points in a walled box with a density that varies as 1 + cos(πx/L)/2:
// connected S(k) = 1 − |p̂(k)|², far from the raw one at small k.
TEST(StructureFactorTheory, ConnectedEstimatorRemovesAStaticProfile) {
    const double length = 20;
    const int frames = 1500;
    const Box box = square_box(length, Boundary::walls);
    const auto density = [&](double x) {
        return (1 + 0.5 * std::cos(std::numbers::pi * x / length)) / length;
    };
    StructureFactor sk({.k_max = 1.2}, box, frames);
    for (int f = 0; f < frames; ++f) {
        RandomStream random(8, "profile", static_cast<std::uint64_t>(f));
        std::vector<Vec2> points;
        while (points.size() < 300) {
            const Vec2 q{length * random.uniform(), length * random.uniform()};
            if (random.uniform() * 1.5 / length < density(q.x)) points.push_back(q);
        }
        sk.add(sk.measure(pattern(std::move(points), box, f)));
    }
    const auto transform = [&](double k, const std::function<double(double)>& p) {
        std::complex<double> sum;
        const int steps = 4000;
        for (int i = 0; i < steps; ++i) {
            const double x = (i + 0.5) * length / steps;
            sum += std::polar(p(x), -k * x) * (length / steps);
        }
        return sum;
    };
    const ObservableResult result = sk.result();
    const Curve* curve = result.find_curve("sk");
    const auto& k = curve->find("k")->values;
    int tested = 0;
    for (std::size_t i = 0; i < k.size(); ++i) {
        double wanted = 0;
        double modes = 0;
        for (const Mode& mode : sk.grid().modes()) {
            const double step = std::numbers::pi / length;
            if (std::abs(mode.k - k[i]) > 1e-6 || k[i] > 5.4 * step) continue;
            const auto px = transform(mode.nx * step, density);
            const auto py = transform(mode.ny * step, [&](double) { return 1 / length; });
            wanted += 1 - std::norm(px * py);
            modes += 1;
        }
        if (modes < 1) continue;
        wanted /= modes;
        // Neighbouring plane waves of the π/L grid are correlated: four of them carry the
        // information of one.
        EXPECT_NEAR(curve->find("s")->values[i], wanted,
                    6 * wanted / std::sqrt(std::max(1.0, modes / 4) * frames))
            << "k = " << k[i];
        ++tested;
    }
    EXPECT_GE(tested, 10);
    EXPECT_GT(result.find_curve("sk_raw")->find("s")->values.front(), 20);
}

TEST(StructureFactorTheory, CosineModesOfUniformPointsBetweenWallsGiveOne) {
    const int frames = 2000;
    const Box box = square_box(20, Boundary::walls);
    const auto result = measure(box, {.k_max = 1.5}, frames, "neumann", [&](RandomStream& random) {
        return poisson_points(300, box, random);
    });
    // c_k is real: c² has a χ² distribution of one degree of freedom, twice the variance.
    expect_curve(result, "sk_neumann", frames, 2, [](double) { return 1.0; });
}

// A density that fluctuates in one mode that fits between the walls, cos(πx/L) cos(πy/L), with
// amplitude ±a from frame to frame: only this mode may rise above 1.
TEST(StructureFactorTheory, CosineModesDoNotLeakIntoEachOther) {
    const int frames = 3000;
    const double length = 20;
    const double amplitude = 0.3;
    const Box box = square_box(length, Boundary::walls);
    StructureFactor sk({.k_max = 1.2}, box, frames);
    for (int f = 0; f < frames; ++f) {
        RandomStream random(9, "no leak", static_cast<std::uint64_t>(f));
        const double a = random.uniform() < 0.5 ? amplitude : -amplitude;
        std::vector<Vec2> points;
        while (points.size() < 300) {
            const Vec2 q{length * random.uniform(), length * random.uniform()};
            const double c = std::cos(std::numbers::pi * q.x / length) *
                             std::cos(std::numbers::pi * q.y / length);
            if (random.uniform() * (1 + amplitude) < 1 + a * c) points.push_back(q);
        }
        sk.add(sk.measure(pattern(std::move(points), box, f)));
    }
    const ObservableResult result = sk.result();
    const auto& s = result.find_curve("sk_neumann")->find("s")->values;
    const auto& n = result.find_curve("sk_neumann")->find("n")->values;
    // Given the sign of a, mode (1, 1) has mean N a/4 and each point the variance 1/4 − (a/4)²:
    // S = 4 (N (1/4 − a²/16) + N² a²/16)/N. All other modes have mean 0 and, over both signs of a,
    // variance N/4.
    const double modulated = 1 + (300 - 1) * amplitude * amplitude / 4;
    EXPECT_NEAR(s[0], modulated, 6 * modulated * std::sqrt(2.0 / frames));
    for (std::size_t i = 1; i < 6; ++i) {
        EXPECT_NEAR(s[i], 1, 6 * std::sqrt(2.0 / (n[i] * frames))) << i;
    }
}

}  // namespace
}  // namespace grainfield::analysis
