// λ = 0: the spectrum of every scheme is known in closed form, at every step.
#include <cmath>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tests/simulate/field/integrators/field_checks.h"

namespace grainfield::simulate {
namespace {

using testing::line;
using testing::plane;
using testing::Spectrum;

FieldSetup without_order(FieldSetup setup, bool twofold, NoiseShape noise) {
    setup.model.lambda = 0;
    setup.has_order = false;
    setup.twofold = twofold;
    setup.noise = noise;
    return setup;
}

// Samples far enough apart that modes with |k| ≥ 1 are new each time (4 D k² t > 8).
Spectrum measured(const FieldSetup& setup, int samples, double apart) {
    const auto fields = make_integrator(setup, 1);
    Spectrum spectrum(setup.lattice);
    const auto steps = static_cast<std::int64_t>(std::ceil(apart / setup.dt));
    fields->advance(steps);
    for (int i = 0; i < samples; ++i) {
        fields->advance(steps);
        spectrum.add(fields->density(0));
    }
    return spectrum;
}

// All modes with |k| ≥ 1 together: relative error 1/sqrt(n modes·samples) with ~n/2 independent
// complex modes; 6 sigma with every mode counted once in pairs.
double six_sigma(const FieldSetup& setup, int samples) {
    return 6 * std::sqrt(2.0 / (static_cast<double>(setup.lattice.cells()) * samples));
}

TEST(FlatSpectrum, LodIsFlatAtEveryStep) {
    for (const double dt : {0.05, 0.5, 3.0}) {
        for (const bool twofold : {false, true}) {
            for (const NoiseShape noise : {NoiseShape::uniform, NoiseShape::normal}) {
                const FieldSetup setup =
                    without_order(plane(32, 31, FieldScheme::lod, dt), twofold, noise);
                // Long steps ring at large k (factor → −1) and take 1/(dt D k²)-many steps to
                // forget.
                const double apart = 2 + 12 * dt;
                const Spectrum s = measured(setup, 150, apart);
                EXPECT_NEAR(s.mean(1, 10) / 0.5, 1, 2 * six_sigma(setup, 150)) << "dt " << dt;
            }
        }
    }
}

TEST(FlatSpectrum, LodIsFlatOnALine) {
    const FieldSetup setup =
        without_order(line(1000, FieldScheme::lod, 0.2), true, NoiseShape::uniform);
    EXPECT_NEAR(measured(setup, 150, 4).mean(1, 13) / 0.5, 1, 2 * six_sigma(setup, 150));
}

TEST(FlatSpectrum, LeimkuhlerMatthewsIsFlatUpToItsBound) {
    for (const double dt : {0.02, 0.05, 0.1}) {
        for (const bool twofold : {false, true}) {
            const FieldSetup setup = without_order(plane(32, 31, FieldScheme::explicit_lm, dt),
                                                   twofold, NoiseShape::uniform);
            const Spectrum s = measured(setup, 200, 2.5);
            EXPECT_NEAR(s.mean(1, 10) / 0.5, 1, six_sigma(setup, 200)) << "dt " << dt;
        }
    }
    const FieldSetup on_line =
        without_order(line(1000, FieldScheme::explicit_lm, 0.03), false, NoiseShape::uniform);
    EXPECT_NEAR(measured(on_line, 150, 2.5).mean(1, 13) / 0.5, 1, six_sigma(on_line, 150));
}

TEST(FlatSpectrum, OtherStrengthsScaleIt) {
    FieldSetup setup =
        without_order(plane(32, 32, FieldScheme::lod, 0.1), true, NoiseShape::uniform);
    setup.model.c1 = 3;
    setup.model.d0 = 2.5;
    EXPECT_NEAR(measured(setup, 150, 2).mean(1, 10) / (3 / 5.0), 1, six_sigma(setup, 150));
}

// Peaceman–Rachford: S = C1/(2 D0) / (1 + a_x a_y), a_i = dt D (2 − 2 cos k_i dx)/(2 dx²).
TEST(FlatSpectrum, ThePublishedSchemeIsLowByItsKnownFactor) {
    for (const double dt : {0.05, 0.5}) {
        const FieldSetup setup =
            without_order(plane(32, 32, FieldScheme::paper, dt), true, NoiseShape::uniform);
        const int samples = 200;
        const Spectrum s = measured(setup, samples, 2 + 12 * dt);
        double expected = 0, got = 0, weight = 0;
        for (int y = 0; y < 32; ++y) {
            for (int x = 0; x <= 16; ++x) {
                if (s.wavenumber(x, y) < 1) continue;
                const auto a = [&](int n) {
                    return dt * (1 - std::cos(2 * std::numbers::pi * n / 32)) / (0.65 * 0.65);
                };
                const double w = x == 0 || x == 16 ? 1 : 2;
                expected += w * 0.5 / (1 + a(x) * a(y));
                got += w * s.at(x, y);
                weight += w;
            }
        }
        EXPECT_NEAR(got / expected, 1, 2 * six_sigma(setup, samples)) << "dt " << dt;
        if (dt > 0.1) {
            EXPECT_LT(got / weight, 0.4);
        }
    }
}

// The plain explicit Euler–Maruyama step, kept as an oracle only: S = C1/(2 D0) / (1 − x/2),
// x = dt D k̂², which is why it should not be used.
TEST(FlatSpectrum, EulerMaruyamaIsHighByItsKnownFactor) {
    const Lattice lattice{2, 32, 32, 0.65};
    const double dt = 0.05;
    const double h = dt / (0.65 * 0.65);
    const double strength = std::sqrt(dt / lattice.cell_volume()) / 0.65;
    RandomStream random(1, "euler");
    std::vector<double> rho(lattice.cells(), 0), next = rho, fx = rho, fy = rho;
    Spectrum spectrum(lattice);
    const auto at = [](int x, int y) {
        return static_cast<std::size_t>((y + 32) % 32 * 32 + (x + 32) % 32);
    };
    for (int step = 0; step < 10000; ++step) {
        for (std::size_t i = 0; i < rho.size(); ++i) {
            fx[i] = strength * random.normal();
            fy[i] = strength * random.normal();
        }
        for (int y = 0; y < 32; ++y) {
            for (int x = 0; x < 32; ++x) {
                const std::size_t i = at(x, y);
                next[i] = rho[i] + fx[i] - fx[at(x - 1, y)] + fy[i] - fy[at(x, y - 1)] +
                          h * (rho[at(x + 1, y)] + rho[at(x - 1, y)] + rho[at(x, y + 1)] +
                               rho[at(x, y - 1)] - 4 * rho[i]);
            }
        }
        rho.swap(next);
        if (step % 50 != 49) continue;
        DensityField field;
        field.nx = field.ny = 32;
        field.spacing = 0.65;
        field.value = rho;
        spectrum.add(field);
    }
    double expected = 0, got = 0;
    for (int y = 0; y < 32; ++y) {
        for (int x = 0; x <= 16; ++x) {
            if (spectrum.wavenumber(x, y) < 1) continue;
            const double k2 = (4 - 2 * std::cos(2 * std::numbers::pi * x / 32) -
                               2 * std::cos(2 * std::numbers::pi * y / 32)) /
                              (0.65 * 0.65);
            const double w = x == 0 || x == 16 ? 1 : 2;
            expected += w * 0.5 / (1 - dt * k2 / 2);
            got += w * spectrum.at(x, y);
        }
    }
    EXPECT_NEAR(got / expected, 1, 8 * std::sqrt(2.0 / (1024.0 * spectrum.count())));
}

}  // namespace
}  // namespace grainfield::simulate
