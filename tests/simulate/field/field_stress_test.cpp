#include <cmath>

#include <gtest/gtest.h>

#include "tests/simulate/field/field_checks.h"

namespace grainfield::simulate {
namespace {

using testing::line;
using testing::plane;

bool is_finite_run(const FieldSetup& setup, std::int64_t steps) {
    const auto fields = make_integrator(setup, 2);
    fields->advance(steps);
    double sum = 0;
    for (int r = 0; r < setup.replicas; ++r) {
        for (const double rho : fields->density(r).value) sum += rho * rho;
    }
    for (const double psi : fields->order().value) sum += psi * psi;
    return std::isfinite(sum) && std::isfinite(fields->mean_diffusivity());
}

TEST(FieldStress, NuZeroAndNearlyZero) {
    for (const double nu : {0.0, 1e-6}) {
        FieldSetup setup = plane(32, 32, FieldScheme::lod, 0.5);
        setup.model.nu = nu;
        EXPECT_TRUE(is_finite_run(setup, 500));
    }
}

TEST(FieldStress, LongSteps) {
    for (const double dt : {10.0, 1000.0}) {
        FieldSetup setup = plane(32, 29, FieldScheme::lod, dt);
        setup.model.nu = 0.003;
        EXPECT_TRUE(is_finite_run(setup, 300)) << dt;
    }
}

// λψ² far beyond the range of exp: D underflows to 0 nearly everywhere.
TEST(FieldStress, DiffusivityThatUnderflows) {
    for (const FieldScheme scheme :
         {FieldScheme::lod, FieldScheme::explicit_lm, FieldScheme::paper}) {
        FieldSetup setup = plane(24, 24, scheme, 0.05);
        setup.model.lambda = 5000;
        EXPECT_TRUE(is_finite_run(setup, 300));
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
            EXPECT_TRUE(is_finite_run(setup, 50)) << nx << " x " << ny;
        }
        for (const int nx : {1, 2, 3, 17, 97})
            EXPECT_TRUE(is_finite_run(line(nx, scheme, 0.02), 50));
    }
}

TEST(FieldStress, OtherFormsOfTheDiffusivity) {
    for (const DiffusivityForm form : {DiffusivityForm::lorentzian, DiffusivityForm::sech}) {
        FieldSetup setup = plane(32, 32, FieldScheme::lod, 0.5);
        setup.model.form = form;
        setup.model.nu = 0.003;
        EXPECT_TRUE(is_finite_run(setup, 200));
    }
}

}  // namespace
}  // namespace grainfield::simulate
