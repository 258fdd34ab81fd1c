// Point processes with closed forms beyond lattices and independent points: Ginibre (eigenvalues of
// random matrices), Thomas (clusters), fields between walls; and the sizes at which estimators
// break. Tolerances are six standard errors or more: p < 1e-7 a test.

#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "analysis/analysis.h"
#include "analysis/density/number_variance.h"
#include "analysis/spectra/fit_result.h"
#include "analysis/spectra/order_structure_factor.h"
#include "tests/analysis/synthetic_patterns.h"
#include "tests/support/pull.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

// Eigenvalues of complex Gaussian matrices have density 1/π within a disc and repel:
// σ²(ℓ) = ρℓ²(1 − ρI²), I = erf(√c ℓ)/√ρ − (1 − exp(−cℓ²))/(cℓ), c = πρ = 1.
TEST(PointProcessTheory, NumberVarianceOfGinibrePointsGrowsWithThePerimeter) {
    constexpr int points = 100;
    constexpr int frames = 200;
    const double side = 10;  // the disc has radius 10; the square reaches to 7.1
    const Box box = square_box(side, Boundary::walls, {-side / 2, -side / 2});
    NumberVariance variance({.largest = 6, .step = 0.5, .border = 0.0}, box, frames);
    for (int f = 0; f < frames; ++f) {
        RandomStream random(3, "ginibre", static_cast<std::uint64_t>(f));
        Eigen::MatrixXcd matrix(points, points);
        for (int i = 0; i < points; ++i) {
            for (int j = 0; j < points; ++j) {
                const double re = random.normal();
                matrix(i, j) = std::complex<double>(re, random.normal()) / std::numbers::sqrt2;
            }
        }
        const Eigen::ComplexEigenSolver<Eigen::MatrixXcd> solver(matrix, false);
        std::vector<Vec2> inside;
        for (const std::complex<double>& z : solver.eigenvalues()) {
            if (std::abs(z.real()) < side / 2 && std::abs(z.imag()) < side / 2) {
                inside.push_back({z.real(), z.imag()});
            }
        }
        variance.add(variance.measure(pattern(std::move(inside), box, f)));
    }
    const Curve curve = *variance.result().find_curve("variance");
    const double rho = 1 / std::numbers::pi;
    for (std::size_t s = 0; s < curve.find("l")->values.size(); ++s) {
        const double l = curve.find("l")->values[s];
        const double overlap = std::erf(l) / std::sqrt(rho) - (1 - std::exp(-l * l)) / l;
        const double wanted = rho * l * l * (1 - rho * overlap * overlap);
        const double windows = frames * std::pow(std::floor(side / l), 2);
        EXPECT_NEAR(curve.find("variance")->values[s], wanted,
                    6 * wanted * std::sqrt((2 + 1 / wanted) / windows))
            << l;
    }
    // Poisson points of this density would have 11.5 at ℓ = 6.
    EXPECT_LT(curve.find("variance")->values.back(), 4);
}

TEST(PointProcessTheory, StructureFactorOfThomasClustersIsOnePlusTheirSizeTimesAGaussian) {
    const double length = 40;
    const double parents = 400;
    const double spread = 0.8;
    const double size = 4;  // mean number of children, Poisson
    const int frames = 400;
    const Box box = square_box(length);
    StructureFactor sk({.k_max = 3}, box, frames);
    const auto poisson = [](RandomStream& random, double mean) {
        int n = 0;
        for (double t = -std::log(1 - random.uniform()); t < mean; ++n) {
            t -= std::log(1 - random.uniform());
        }
        return n;
    };
    for (int f = 0; f < frames; ++f) {
        RandomStream random(4, "thomas", static_cast<std::uint64_t>(f));
        std::vector<Vec2> points;
        for (int p = poisson(random, parents); p > 0; --p) {
            const Vec2 at{length * random.uniform(), length * random.uniform()};
            for (int c = poisson(random, size); c > 0; --c) {
                points.push_back(at + spread * Vec2{random.normal(), random.normal()});
            }
        }
        sk.add(sk.measure(pattern(std::move(points), box, f)));
    }
    const Curve curve = *sk.result().find_curve("sk");
    for (std::size_t i = 0; i < curve.find("k")->values.size(); ++i) {
        const double k = curve.find("k")->values[i];
        const double wanted = 1 + size * std::exp(-k * k * spread * spread);
        const double modes = curve.find("n")->values[i] * frames;
        // Number fluctuations and shells one step wide add half a percent.
        EXPECT_NEAR(curve.find("s")->values[i], wanted, wanted * (6 / std::sqrt(modes) + 0.01))
            << k;
    }
}

// ∫_0^L cos(πnx/L) exp(−iπmx/L) dx / L.
std::complex<double> overlap(int n, int m) {
    const auto part = [](int d) -> std::complex<double> {
        if (d == 0) return 1;
        const std::complex<double> i(0, 1);
        const double phase = std::numbers::pi * d;
        return (std::exp(i * phase) - 1.0) / (i * phase);
    };
    return 0.5 * (part(n - m) + part(-n - m));
}

// A density between walls, Σ a cos(πn_x x/L) cos(πn_y y/L) with S = S0 + (ka)^1.12 up to n = most
// and no flux through the walls, as its plane waves on the π/L grid.
class WalledField {
 public:
    WalledField(double length, double particles, int most)
        : length_(length),
          particles_(particles),
          most_(most),
          x_(most + 1, most + 1),
          y_(2 * most + 1, most + 1) {
        for (int m = -most; m <= most; ++m) {
            for (int n = 0; n <= most; ++n) {
                const auto value = overlap(n, m);
                if (m >= 0) x_(m, n) = value;
                y_(m + most, n) = value;
            }
        }
    }

    StructureFactor::Sample frame(double s0, const ModeGrid& grid, RandomStream& random) const {
        Eigen::MatrixXcd a = Eigen::MatrixXcd::Zero(most_ + 1, most_ + 1);
        for (int nx = 0; nx <= most_; ++nx) {
            for (int ny = 0; ny <= most_; ++ny) {
                if (nx + ny == 0) continue;
                const double k = std::numbers::pi / length_ * std::hypot(nx, ny);
                const double s = s0 + std::pow(k, 1.12);
                const double norm = (nx > 0 ? 0.5 : 1.0) * (ny > 0 ? 0.5 : 1.0);
                // c = a · norm (L² in a) has the variance N S norm.
                a(nx, ny) = std::sqrt(particles_ * s / norm) * random.normal();
            }
        }
        const Eigen::MatrixXcd modes = x_ * a * y_.transpose();
        StructureFactor::Sample sample{particles_, {}};
        for (const Mode& mode : grid.modes()) {
            sample.rho.push_back(modes(mode.nx, mode.ny + most_));
        }
        return sample;
    }

 private:
    double length_;
    double particles_;
    int most_;
    Eigen::MatrixXcd x_, y_;  // plane waves in cosines
};

// 500 trials: an honest pull has a mean known to 0.045 and a width known to 0.032; the bars 0.15
// and 0.85–1.15 are those asked for, and the seeds are fixed.
TEST(PointProcessTheory, CosineModesBetweenWallsGiveTheTrueRatioWithItsError) {
    constexpr double length = 100;
    constexpr int frames = 60;
    const Box box = square_box(length, Boundary::walls);
    const WalledField field(length, 11704, 14);
    for (const double s0 : {0.0, 0.01, 0.1}) {
        testing::Pull pull;
        for (std::uint64_t trial = 0; trial < 500; ++trial) {
            StructureFactor sk({.k_max = 0.42}, box, frames);
            RandomStream random(60, "walls", trial);
            for (int f = 0; f < frames; ++f) sk.add(field.frame(s0, sk.grid(), random));
            const SpectrumFit fit =
                fit_spectrum(sk.spectrum(StructureFactor::Estimator::neumann), 0.4, 1.12);
            ASSERT_TRUE(fit.ok()) << fit.reason;
            pull.add((fit.ratio() - s0) / fit.ratio_error());
        }
        EXPECT_LT(std::abs(pull.mean()), 0.15) << s0;
        EXPECT_GT(pull.width(), 0.85) << s0;
        EXPECT_LT(pull.width(), 1.15) << s0;
    }
}

// Ten runs know the mean of plane waves to 0.0005 (measured scatter of a run: 0.0015).
TEST(PointProcessTheory, PlaneWavesBetweenWallsLeak) {
    constexpr int frames = 100;
    constexpr int runs = 10;
    const Box box = square_box(100, Boundary::walls);
    const WalledField field(100, 11704, 36);
    for (const double s0 : {0.0, 0.01}) {
        double leaked = 0;
        for (std::uint64_t run = 0; run < runs; ++run) {
            StructureFactor sk({.k_max = 0.45}, box, frames);
            RandomStream random(61, "leak", run);
            for (int f = 0; f < frames; ++f) sk.add(field.frame(s0, sk.grid(), random));
            const SpectrumFit plane =
                fit_spectrum(sk.spectrum(StructureFactor::Estimator::connected), 0.4, 1.12);
            leaked += plane.ratio() / runs;
        }
        EXPECT_LT(leaked, s0 - 0.002) << s0;
    }
}

TEST(PointProcessTheory, HoldsForTenMillionPointsStreamedThroughTheAnalysis) {
    class Stream final : public SnapshotSource {
     public:
        const TrajectoryInfo& info() const override { return info_; }
        std::int64_t count() const override { return 2; }
        Snapshot read(std::int64_t index) override {
            RandomStream random(9, "stream", static_cast<std::uint64_t>(index));
            Snapshot s;
            s.frame = index;
            s.box = square_box(3000);
            s.position = poisson_points(10'000'000, s.box, random);
            return s;
        }

     private:
        TrajectoryInfo info_;
    };
    Stream source;
    AnalysisOptions options;
    options.observables = {"sk", "variance"};
    options.of<StructureFactorOptions>().k_max = 0.1;
    options.of<NumberVarianceOptions>() = {
        .smallest = 10, .largest = 20, .increment = 10, .step = 5};
    const auto results = measure(source, options, {.threads = 1}).observables;
    const Curve* sk = results[0].find_curve("sk");
    const double modes =
        2 * std::accumulate(sk->find("n")->values.begin(), sk->find("n")->values.end(), 0.0);
    double mean = 0;
    for (std::size_t i = 0; i < sk->find("s")->values.size(); ++i) {
        mean += sk->find("s")->values[i] * sk->find("n")->values[i] * 2 / modes;
    }
    EXPECT_NEAR(mean, 1, 6 / std::sqrt(modes));
    const Curve* variance = results[1].find_curve("variance");
    EXPECT_NEAR(variance->find("mean")->values[0], 1e7 / 9e4, 1e-6);
    EXPECT_NEAR(variance->find("variance")->values[0], 1e7 / 9e4,
                6 * 1e7 / 9e4 * std::sqrt(2.0 / 9e4));
}

TEST(PointProcessTheory, BoxesOfAThousandthAndOfAMillionDiametersGiveNumbersOrReasons) {
    for (const double length : {1e-3, 1e6}) {
        for (const Boundary boundary : {Boundary::periodic, Boundary::walls}) {
            MemorySource source;
            for (int f = 0; f < 10; ++f) {
                RandomStream random(11, "sizes", static_cast<std::uint64_t>(f));
                Snapshot s;
                s.frame = f;
                s.time = f;
                s.box = square_box(length, boundary, {1e6, -1e6});
                s.position = poisson_points(60, s.box, random);
                s.id = identities(60);
                source.snapshots.push_back(std::move(s));
            }
            AnalysisOptions options;
            options.of<StructureFactorOptions>().k_max = 30 / length;
            options.of<OrderStructureFactorOptions>().modes.k_max = 30 / length;
            options.of<NumberVarianceOptions>() = {.smallest = length / 10,
                                                   .largest = length / 2,
                                                   .increment = length / 10,
                                                   .step = length / 40};
            options.of<FitOptions>().k_max = 20 / length;
            for (const ObservableResult& r : measure(source, options, {.threads = 2}).observables) {
                if (r.measurements.empty()) {
                    EXPECT_NE(r.reason, "") << r.name << length;
                }
                for (const Measurement& m : r.measurements) {
                    EXPECT_TRUE(m.value ? std::isfinite(*m.value) : !m.reason.empty())
                        << r.name << " " << m.name << " " << length;
                }
                if (r.name == "sk") {
                    EXPECT_NEAR(r.find_curve("sk")->find("s")->values.back(), 1, 0.9);
                }
            }
        }
    }
}

}  // namespace
}  // namespace grainfield::analysis
