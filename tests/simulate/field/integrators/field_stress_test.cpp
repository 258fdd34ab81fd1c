#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/simulate/field/integrators/field_checks.h"

namespace grainfield::simulate {
namespace {

using testing::line;
using testing::plane;

// P(χ²_n < n − 2 sqrt(n x)) and P(χ²_n > n + 2 sqrt(n x) + 2 x) are at most exp(−x) each
// [laurent2000]; here 1e-6.
constexpr double unlikely = 13.8;

// What must hold however rough the fields are. Given ψ, ρ is Gaussian, and D ≤ D0:
//
//   C1/(2 D0) ≤ S(k) ≤ C1/(2 D0) + C1 k̂² t,   k̂² ≤ 4 d/dx².
//
// The lower bound is that of the noise against the fastest diffusion; it holds at every step of the
// integrators that leave C1/(2 D0) for constant D. The upper one is the white beginning plus all
// noise, as diffusion only takes away. The sum of ρ² over n + 1 cells lies between the same
// multiples of a χ² number with n degrees of freedom. Mass: each of some 16 operations on a cell
// errs by half a unit in the last place of a number as large as the largest ρ, times what a solve
// may amplify.
void expect_bounded_run(FieldSetup setup, std::int64_t steps, const std::string& what) {
    setup.noise = NoiseShape::normal;
    const auto fields = make_integrator(setup, 2);
    fields->advance(steps);
    const Lattice& lattice = setup.lattice;
    const ModelOptions& model = setup.model;
    const double white = model.c1 / (2 * model.d0);
    const double dx2 = lattice.spacing * lattice.spacing;
    const double gathered = model.c1 * 4 * lattice.dimension / dx2 * fields->time();
    const double n = static_cast<double>(lattice.cells()) - 1;
    const double low = n - 2 * std::sqrt(n * unlikely);
    const double high = n + 2 * std::sqrt(n * unlikely) + 2 * unlikely;
    for (int r = 0; r < setup.replicas; ++r) {
        double sum = 0;
        double largest = 0;
        for (const double rho : fields->density(r).value) {
            sum += rho * rho * lattice.cell_volume();
            largest = std::max(largest, std::abs(rho));
        }
        const double least = setup.scheme == FieldScheme::paper ? 0 : white * low;
        EXPECT_GE(sum, least) << what;
        EXPECT_LE(sum, (white + gathered) * high + 1e-9) << what;
        const double amplified = 1 + setup.dt * model.d0 / dx2;
        const double rounding = 16 * 6e-8 * amplified * largest * static_cast<double>(steps);
        EXPECT_LE(std::abs(fields->mass(r)), rounding * lattice.volume() + 1e-12) << what;
    }
    for (const double psi : fields->order().value) ASSERT_TRUE(std::isfinite(psi)) << what;
    EXPECT_GE(fields->mean_diffusivity(), 0) << what;
    EXPECT_LE(fields->mean_diffusivity(), model.d0 * (1 + 1e-6)) << what;
}

TEST(FieldStress, NuZeroAndNearlyZero) {
    for (const double nu : {0.0, 1e-6}) {
        FieldSetup setup = plane(32, 32, FieldScheme::lod, 0.5);
        setup.model.nu = nu;
        expect_bounded_run(setup, 500, fmt::format("nu {}", nu));
    }
}

TEST(FieldStress, LongSteps) {
    for (const double dt : {10.0, 1000.0}) {
        FieldSetup setup = plane(32, 29, FieldScheme::lod, dt);
        setup.model.nu = 0.003;
        expect_bounded_run(setup, 300, fmt::format("dt {}", dt));
    }
}

// λψ² far beyond the range of exp: D underflows to 0 nearly everywhere.
TEST(FieldStress, DiffusivityThatUnderflows) {
    for (const FieldScheme scheme :
         {FieldScheme::lod, FieldScheme::explicit_lm, FieldScheme::paper}) {
        FieldSetup setup = plane(24, 24, scheme, 0.05);
        setup.model.lambda = 5000;
        expect_bounded_run(setup, 300, fmt::format("scheme {}", static_cast<int>(scheme)));
        const auto fields = make_integrator(setup, 1);
        double largest = 0;
        for (const double psi : fields->order().value)
            largest = std::max(largest, 5000 * psi * psi);
        EXPECT_GT(largest, 700);
    }
}

TEST(FieldStress, NoDiffusionAtAll) {
    FieldSetup setup = plane(16, 16, FieldScheme::lod, 0.5);
    setup.model.d0 = 0;
    const auto fields = make_integrator(setup, 1);
    EXPECT_EQ(fields->mass(0), 0);
    fields->advance(100);
    // ρ only gathers noise: variance of a cell 2 d C1 t/(dx^d dx²), here from 256 cells (± 5
    // sigma).
    double square = 0;
    for (const double rho : fields->density(0).value) square += rho * rho / 256;
    const double expected = 4 * 50 / std::pow(0.65, 4);
    EXPECT_NEAR(square / expected, 1, 5 * std::sqrt(2.5 * 2 / 256.0));
}

TEST(FieldStress, NoNoise) {
    FieldSetup setup = plane(16, 16, FieldScheme::lod, 0.5);
    setup.model.c1 = 0;
    setup.model.c2 = 0;
    const auto fields = make_integrator(setup, 1);
    fields->advance(20);
    for (const double rho : fields->density(0).value) EXPECT_EQ(rho, 0);
    EXPECT_EQ(fields->mean_diffusivity(), 1);
}

TEST(FieldStress, OddPrimeThinAndTinyLattices) {
    for (const FieldScheme scheme :
         {FieldScheme::lod, FieldScheme::explicit_lm, FieldScheme::paper}) {
        for (const auto& [nx, ny] :
             {std::pair{1, 50}, {2, 2}, {3, 3}, {4, 4}, {31, 37}, {101, 2}, {2, 101}}) {
            FieldSetup setup = plane(nx, ny, scheme, 0.05);
            setup.replicas = 2;
            expect_bounded_run(setup, 50, fmt::format("{} x {}", nx, ny));
        }
        for (const int nx : {1, 2, 3, 17, 97})
            expect_bounded_run(line(nx, scheme, 0.02), 50, fmt::format("line of {}", nx));
    }
}

TEST(FieldStress, OtherFormsOfTheDiffusivity) {
    for (const DiffusivityForm form : {DiffusivityForm::lorentzian, DiffusivityForm::sech}) {
        FieldSetup setup = plane(32, 32, FieldScheme::lod, 0.5);
        setup.model.form = form;
        setup.model.nu = 0.003;
        expect_bounded_run(setup, 200, fmt::format("form {}", static_cast<int>(form)));
    }
}

// λ = 0 with ψ alive and near its critical point: D = D0, so S(k) = C1/(2 D0) at every k.
// 200 samples of some 500 modes: 6 standard deviations are 6 sqrt(2/(500 · 200)) = 2.7 %.
TEST(FieldStress, ALongStepLeavesTheSpectrumThatTheoryGives) {
    for (const double dt : {0.5, 3.0}) {
        FieldSetup setup = plane(32, 31, FieldScheme::lod, dt);
        setup.model.lambda = 0;
        setup.model.nu = 0.003;
        const auto fields = make_integrator(setup, 1);
        testing::Spectrum spectrum(setup.lattice);
        const auto apart = static_cast<std::int64_t>(std::ceil((2 + 12 * dt) / dt));
        for (int sample = 0; sample < 200; ++sample) {
            fields->advance(apart);
            spectrum.add(fields->density(0));
        }
        EXPECT_NEAR(spectrum.mean(1, 10) / 0.5, 1, 0.027) << dt;
    }
}

}  // namespace
}  // namespace grainfield::simulate
