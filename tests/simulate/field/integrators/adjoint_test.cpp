#include "simulate/field/integrators/adjoint.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "simulate/field/field_plan.h"
#include "simulate/field/integrators/integrator_choice.h"
#include "tests/simulate/field/integrators/field_checks.h"
#include "tests/simulate/field/integrators/plain_adjoint.h"

namespace grainfield::simulate {
namespace {

using testing::line;
using testing::plane;

// Constant D: ‖∇φ‖² integrates to 1/(2 D0) in any number of steps, up to the rest (1e-4), which is
// accounted for.
TEST(Adjoint, ConstantDiffusivityGivesTheFlatSpectrumWithoutNoise) {
    for (const double dt : {0.05, 0.5}) {
        for (const bool on_line : {false, true}) {
            FieldSetup setup =
                on_line ? line(64, FieldScheme::lod, dt) : plane(24, 18, FieldScheme::lod, dt);
            setup.model.lambda = 0;
            setup.has_order = false;
            setup.twofold = true;
            setup.model.c1 = 3;
            setup.model.d0 = 2;
            std::vector<LatticeWave> waves{{1, 0}, {3, 0}};
            if (!on_line) waves.push_back({2, 3});
            AdjointEstimator adjoint(setup, waves, 1);
            adjoint.advance(static_cast<std::int64_t>(200 / dt));
            for (std::size_t w = 0; w < waves.size(); ++w) {
                ASSERT_GE(adjoint.samples(w).size(), 2U);
                for (const double s : adjoint.samples(w)) EXPECT_NEAR(s, 0.75, 2e-6);
            }
        }
    }
}

// S ≥ C1/(2 D0) whatever ψ does: for every path, not only on average.
TEST(Adjoint, NeverFallsBelowTheBound) {
    FieldSetup setup = plane(32, 32, FieldScheme::lod, 0.5);
    setup.model.nu = 0.01;
    AdjointEstimator adjoint(setup, {{2, 0}, {0, 5}, {9, 0}}, 1);
    adjoint.advance(4000);
    for (std::size_t w = 0; w < adjoint.waves(); ++w) {
        ASSERT_GE(adjoint.samples(w).size(), 3U);
        for (const double s : adjoint.samples(w)) EXPECT_GT(s, 0.5);
    }
}

TEST(Adjoint, ThreadsAndCheckpointsChangeNoBit) {
    FieldSetup setup = plane(35, 20, FieldScheme::lod, 0.5);
    setup.model.nu = 0.05;
    const std::vector<LatticeWave> waves{{3, 0}, {0, 2}};
    AdjointEstimator one(setup, waves, 1);
    one.advance(600);
    AdjointEstimator two(setup, waves, 3);
    two.advance(311);
    Checkpoint checkpoint;
    two.save(checkpoint);
    AdjointEstimator three(setup, waves, 2);
    three.restore(checkpoint);
    three.advance(600 - 311);
    for (std::size_t w = 0; w < waves.size(); ++w) {
        ASSERT_GE(one.samples(w).size(), 1U);
        EXPECT_EQ(one.samples(w), three.samples(w));
        EXPECT_EQ(one.under_way(w), three.under_way(w));
    }
}

TEST(Adjoint, RefusesACheckpointOfAStretchThatHasNotBegun) {
    const FieldSetup setup = plane(16, 16, FieldScheme::lod, 0.5);
    AdjointEstimator adjoint(setup, {{1, 0}}, 1);
    adjoint.advance(3);
    Checkpoint good;
    adjoint.save(good);
    EXPECT_NO_THROW(adjoint.restore(good));
    for (const std::int64_t begin : {std::int64_t{4}, std::int64_t{-1}}) {
        Checkpoint bad = good;
        bad.integers["adjoint begin"] = {begin};
        EXPECT_THROW(adjoint.restore(bad), InputError) << begin;
    }
    Checkpoint bad = good;
    bad.integers["step"] = {std::numeric_limits<std::int64_t>::max()};
    EXPECT_THROW(adjoint.restore(bad), InputError);
}

TEST(Adjoint, RefusesWhatHasNoAnswer) {
    const FieldSetup setup = plane(16, 16, FieldScheme::lod, 0.5);
    EXPECT_THROW(AdjointEstimator(setup, {{0, 0}}, 1), OptionError);
    EXPECT_THROW(AdjointEstimator(setup, {{9, 0}}, 1), OptionError);
    EXPECT_THROW(AdjointEstimator(setup, {}, 1), OptionError);
    FieldSetup frozen = setup;
    frozen.model.d0 = 0;
    EXPECT_THROW(AdjointEstimator(frozen, {{1, 0}}, 1), OptionError);
}

// The same paths of ψ for all settings, so that a bias is a difference of numbers without density
// noise; what modes that are left out do to one path averages out over the lattice and the paths.
double s_on_paths(double nu, double dt, double k_cut, int hold, int n) {
    constexpr double fine = 0.1;
    constexpr int paths = 3;
    FieldSetup setup = plane(96, 96, FieldScheme::lod, dt);
    setup.model.nu = nu;
    setup.k_cut = k_cut;
    setup.hold = hold;
    setup.substeps = static_cast<int>(std::lround(dt * hold / fine));
    double sum = 0;
    for (int path = 0; path < paths; ++path) {
        setup.seed = static_cast<std::uint64_t>(path + 1);
        AdjointEstimator adjoint(setup, {{n, 0}, {0, n}}, 1, 0);
        adjoint.advance(static_cast<std::int64_t>(std::lround(120 / dt)));
        sum += (adjoint.under_way(0) + adjoint.under_way(1)) / (2 * paths);
    }
    return sum;
}

constexpr double everything = 1e9;

TEST(Adjoint, HalfAUnitOfTimeBiasesLessThanOnePercent) {
    for (const double nu : {0.01, 0.003}) {
        for (const int n : {4, 12}) {  // k = 0.40, 1.21
            const double fine = s_on_paths(nu, 0.1, everything, 1, n);
            EXPECT_NEAR(s_on_paths(nu, 0.5, everything, 1, n) / fine, 1, 0.01) << nu << " " << n;
        }
    }
}

// First order in the step: at small k the bias falls from 2 to 1/2 by about 4.
TEST(Adjoint, TheBiasOfTheStepIsOfFirstOrder) {
    const double fine = s_on_paths(0.01, 0.1, everything, 1, 2);
    const double two = s_on_paths(0.01, 2, everything, 1, 2) / fine - 1;
    const double half = s_on_paths(0.01, 0.5, everything, 1, 2) / fine - 1;
    EXPECT_GT(two, 0.005);
    EXPECT_LT(std::abs(half), 0.45 * two);
}

// S of a scheme on one path of ψ, by transposed steps in plain loops: what the plan chooses for the
// explicit scheme, and the published one.
double s_of_plain_steps(FieldScheme scheme, double dt, int hold) {
    constexpr int cells = 48;
    constexpr double fine = 0.05;
    FieldSetup carrier = plane(cells, cells, FieldScheme::lod, dt * hold);
    carrier.model.nu = 0.01;
    carrier.twofold = true;
    carrier.substeps = static_cast<int>(std::lround(dt * hold / fine));
    const auto path = make_integrator(carrier, 1);
    const auto diffusivity = [&] {
        std::vector<double> d = path->order().value;
        for (double& x : d) x = std::exp(-x * x);
        return d;
    };
    testing::PlainAdjoint wave(cells, 0.65, 2, 2);
    std::vector<double> d = diffusivity();
    for (int i = 0; i < static_cast<int>(std::lround(40 / (dt * hold))); ++i) {
        path->advance(1);
        const std::vector<double> next = diffusivity();
        for (std::size_t j = 0; j < d.size(); ++j) d[j] = 0.5 * (d[j] + next[j]);
        for (int h = 0; h < hold; ++h) {
            if (scheme == FieldScheme::explicit_lm) {
                wave.leimkuhler_matthews(d, dt, 1);
            } else {
                wave.peaceman_rachford(next, dt, 1);
            }
        }
        d = next;
    }
    return wave.sum();
}

// The same quantity by three schemes, whose biases at this step are below 0.3 %.
TEST(Adjoint, AllSchemesAgreeOnOnePath) {
    const double explicit_lm = s_of_plain_steps(FieldScheme::explicit_lm, 0.05, 1);
    EXPECT_NEAR(s_of_plain_steps(FieldScheme::paper, 0.05, 1) / explicit_lm, 1, 0.005);
    FieldSetup setup = plane(48, 48, FieldScheme::lod, 0.05);
    setup.model.nu = 0.01;
    setup.twofold = true;
    AdjointEstimator lod(setup, {{2, 2}}, 1, 0);
    lod.advance(800);
    EXPECT_NEAR(lod.under_way(0) / explicit_lm, 1, 0.005);
}

// The skip of the plan for the explicit scheme, at the hold that its tolerance of 0.5 % leads to.
TEST(Adjoint, HoldingTheOrderFieldUnderTheExplicitSchemeChangesSWithinTheTolerance) {
    FieldOptions options;
    options.scheme.dt = 0.05;
    RunPlan plan;
    const int hold = plan_field(options, plan).setup.hold;
    EXPECT_GT(hold, 1);
    const double each = s_of_plain_steps(FieldScheme::explicit_lm, 0.05, 1);
    EXPECT_NEAR(s_of_plain_steps(FieldScheme::explicit_lm, 0.05, hold) / each, 1, 0.005) << hold;
}

// Second order in dx: D on a face is the mean of its cells. ψ is smooth (b = 8, μ = 100) and the
// same function of space on all lattices, as a mode has the same noise whatever else is kept.
TEST(Adjoint, TheErrorOfTheLatticeIsOfSecondOrder) {
    const auto s_on_lattice = [](int n) {
        FieldSetup setup = plane(n, n, FieldScheme::lod, 0.5);
        setup.lattice.spacing = 31.2 / n;
        setup.model.nu = 0.01;
        setup.model.mu = 100;
        setup.model.b = 8;
        setup.twofold = true;
        AdjointEstimator adjoint(setup, {{3, 0}}, 1, 0);
        adjoint.advance(60);
        return adjoint.under_way(0);
    };
    const double s24 = s_on_lattice(24);
    const double s48 = s_on_lattice(48);
    const double s96 = s_on_lattice(96);
    EXPECT_GT(std::abs(s48 / s24 - 1), 1e-4);
    EXPECT_NEAR((s48 - s24) / (s96 - s48), 4, 0.5);
}

// The skips of the plan, at the settings that its tolerance of 0.5 % leads to.
TEST(Adjoint, LeavingOutFastModesChangesSWithinTheTolerance) {
    for (const int n : {4, 12, 22}) {
        const double all = s_on_paths(0.003, 0.5, everything, 1, n);
        EXPECT_NEAR(s_on_paths(0.003, 0.5, 2.05, 1, n) / all, 1, 0.005) << n;
    }
}

TEST(Adjoint, HoldingTheOrderFieldChangesSWithinTheTolerance) {
    for (const int n : {4, 12}) {
        const double fine = s_on_paths(0.01, 0.1, everything, 1, n);
        EXPECT_NEAR(s_on_paths(0.01, 0.1, everything, 3, n) / fine, 1, 0.005) << n;
    }
}

}  // namespace
}  // namespace grainfield::simulate
