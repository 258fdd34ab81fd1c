#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "simulate/field/integrators/integrator_choice.h"
#include "tests/simulate/field/integrators/field_checks.h"

namespace grainfield::simulate {
namespace {

using ::testing::HasSubstr;
using testing::line;
using testing::plane;

constexpr FieldScheme schemes[] = {FieldScheme::lod, FieldScheme::explicit_lm, FieldScheme::paper};

// ---- A step against plain arithmetic, without density noise ---------------------------------

using Values = std::vector<double>;

struct Plain {
    Lattice lattice;
    double h;  // dt/(4 dx²)

    std::size_t at(int x, int y) const {
        const int nx = lattice.nx;
        const int ny = lattice.ny;
        return static_cast<std::size_t>((y + ny) % ny * nx + (x + nx) % nx);
    }
    // (A ρ) of one direction: Σ over both faces of h (D + D')(ρ − ρ').
    Values flux(const Values& d, const Values& rho, bool along_x) const {
        Values out(rho.size());
        for (int y = 0; y < lattice.ny; ++y) {
            for (int x = 0; x < lattice.nx; ++x) {
                const std::size_t i = at(x, y);
                for (const int side : {-1, 1}) {
                    const std::size_t j = along_x ? at(x + side, y) : at(x, y + side);
                    out[i] += h * (d[i] + d[j]) * (rho[i] - rho[j]);
                }
            }
        }
        return out;
    }
    // (1 + A)^{-1} r by conjugate gradients to rounding.
    Values solve(const Values& d, const Values& r, bool along_x) const {
        Values q(r.size(), 0), rest = r, p = r;
        double square = dot(rest, rest);
        for (int i = 0; i < 2000 && square > 1e-30; ++i) {
            Values ap = flux(d, p, along_x);
            for (std::size_t c = 0; c < p.size(); ++c) ap[c] += p[c];
            const double alpha = square / dot(p, ap);
            for (std::size_t c = 0; c < p.size(); ++c) {
                q[c] += alpha * p[c];
                rest[c] -= alpha * ap[c];
            }
            const double next = dot(rest, rest);
            for (std::size_t c = 0; c < p.size(); ++c) p[c] = rest[c] + next / square * p[c];
            square = next;
        }
        return q;
    }
    static double dot(const Values& a, const Values& b) {
        double sum = 0;
        for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
        return sum;
    }
};

Values diffusivity(const FieldIntegrator& fields) {
    Values d = fields.order().value;
    for (double& value : d) {
        value = fields.setup().model.d0 * std::exp(-fields.setup().model.lambda * value * value);
    }
    return d;
}

Values expected_step(const FieldSetup& setup, const Values& rho, const Values& before,
                     const Values& after) {
    const Lattice& lattice = setup.lattice;
    const Plain plain{lattice, setup.dt / (4 * lattice.spacing * lattice.spacing)};
    Values mean = before;
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] = (before[i] + after[i]) / 2;
    Values out = rho;
    const auto crank_nicolson = [&](const Values& d, bool along_x) {
        const Values q = plain.solve(d, out, along_x);
        for (std::size_t i = 0; i < out.size(); ++i) out[i] = 2 * q[i] - out[i];
    };
    const auto subtract = [&](const Values& flux, double times) {
        for (std::size_t i = 0; i < out.size(); ++i) out[i] -= times * flux[i];
    };
    const bool has_y = lattice.dimension == 2;
    switch (setup.scheme) {
        case FieldScheme::lod:
            crank_nicolson(mean, true);
            if (has_y) crank_nicolson(mean, false);
            break;
        case FieldScheme::explicit_lm: {
            const Values x = plain.flux(mean, rho, true);
            const Values y = plain.flux(mean, rho, false);
            subtract(x, 2);
            if (has_y) subtract(y, 2);
            break;
        }
        case FieldScheme::paper:
            if (!has_y) {
                crank_nicolson(before, true);
                break;
            }
            subtract(plain.flux(before, out, false), 1);
            out = plain.solve(before, out, true);
            subtract(plain.flux(before, out, true), 1);
            out = plain.solve(before, out, false);
            break;
    }
    return out;
}

void expect_plain_step(FieldSetup setup, double tolerance) {
    const auto fields = make_integrator(setup, 1);  // white density
    Checkpoint state;
    fields->save(state);
    setup.model.c1 = 0;  // no noise from here on
    const auto quiet = make_integrator(setup, 2);
    quiet->restore(state);
    const Values before = diffusivity(*quiet);
    quiet->advance(1);
    for (int replica = 0; replica < setup.replicas; ++replica) {
        const Values rho = state.reals.at(fmt::format("density {}", replica));
        const Values expected = expected_step(setup, rho, before, diffusivity(*quiet));
        const Values got = quiet->density(replica).value;
        for (std::size_t i = 0; i < got.size(); ++i) {
            ASSERT_NEAR(got[i], expected[i], tolerance)
                << setup.lattice.nx << " x " << setup.lattice.ny << " scheme "
                << static_cast<int>(setup.scheme) << " cell " << i << " replica " << replica;
        }
    }
}

TEST(FieldIntegrator, AStepIsThatOfPlainArithmetic) {
    for (const FieldScheme scheme : schemes) {
        for (const auto& [nx, ny] : {std::pair{8, 8}, {13, 7}, {1, 9}, {2, 3}, {4, 4}, {33, 18}}) {
            FieldSetup setup = plane(nx, ny, scheme, 0.08);
            setup.model.nu = 0.02;
            setup.twofold = true;
            expect_plain_step(setup, 1e-12);
            setup.twofold = false;
            expect_plain_step(setup, 2e-5);
        }
        for (const int nx : {1, 2, 7, 40, 100}) {
            FieldSetup setup = line(nx, scheme, 0.02);
            setup.replicas = 2;
            setup.twofold = true;
            expect_plain_step(setup, 1e-12);
            setup.twofold = false;
            expect_plain_step(setup, 2e-5);
        }
    }
}

TEST(FieldIntegrator, ALongStepOfTheDefaultSchemeToo) {
    FieldSetup setup = plane(20, 11, FieldScheme::lod, 10);
    setup.twofold = true;
    expect_plain_step(setup, 1e-11);
}

// ---- Threads, restart, mass -----------------------------------------------------------------

TEST(FieldIntegrator, AnyNumberOfThreadsGivesTheSameBits) {
    for (const FieldScheme scheme : schemes) {
        for (const bool twofold : {false, true}) {
            FieldSetup setup = plane(67, 50, scheme, 0.05);
            setup.twofold = twofold;
            setup.replicas = 2;
            setup.k_cut = 3;
            setup.hold = scheme == FieldScheme::explicit_lm ? 3 : 1;
            const auto one = make_integrator(setup, 1);
            one->advance(7);
            for (const int threads : {2, 3, 8}) {
                const auto many = make_integrator(setup, threads);
                many->advance(7);
                for (const int replica : {0, 1}) {
                    EXPECT_EQ(many->density(replica).value, one->density(replica).value);
                }
                EXPECT_EQ(many->order().value, one->order().value);
            }
        }
    }
}

TEST(FieldIntegrator, GoesOnBitByBitAfterACheckpoint) {
    for (const FieldScheme scheme : schemes) {
        for (const int hold : {1, 4}) {
            if (scheme == FieldScheme::paper && hold > 1) continue;
            for (const bool on_line : {false, true}) {
                FieldSetup setup = on_line ? line(50, scheme, 0.02) : plane(24, 17, scheme, 0.05);
                setup.hold = hold;
                setup.replicas = 2;
                const auto whole = make_integrator(setup, 1);
                whole->advance(23);
                const auto first = make_integrator(setup, 1);
                first->advance(10);
                Checkpoint checkpoint;
                first->save(checkpoint);
                const auto second = make_integrator(setup, 1);
                second->advance(3);
                second->restore(checkpoint);
                EXPECT_EQ(second->step(), 10);
                second->advance(13);
                EXPECT_EQ(second->density(1).value, whole->density(1).value);
                EXPECT_EQ(second->order().value, whole->order().value);
                EXPECT_EQ(second->mean_diffusivity(), whole->mean_diffusivity());
            }
        }
    }
}

std::string refusal(const FieldSetup& setup, const Checkpoint& checkpoint) {
    try {
        make_integrator(setup, 1)->restore(checkpoint);
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

TEST(FieldIntegrator, RefusesACheckpointThatCannotBeUsed) {
    const FieldSetup setup = plane(8, 8, FieldScheme::lod, 0.5);
    Checkpoint good;
    make_integrator(setup, 1)->save(good);
    Checkpoint bad = good;
    bad.reals["density 0"][17] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(refusal(setup, bad), HasSubstr("'density 0' holds nan at position 17"));
    bad = good;
    bad.reals["order"][1] = std::numeric_limits<double>::infinity();
    EXPECT_THAT(refusal(setup, bad), HasSubstr("'order' holds inf"));
    bad = good;
    bad.reals.erase("diffusivity");
    EXPECT_THAT(refusal(setup, bad), HasSubstr("has no 'diffusivity'"));
    bad = good;
    bad.reals["density 0"].pop_back();
    EXPECT_THAT(refusal(setup, bad), HasSubstr("63 numbers"));
    bad = good;
    bad.integers.clear();
    EXPECT_THAT(refusal(setup, bad), HasSubstr("no step"));
    bad = good;
    bad.kind = "md";
    EXPECT_THAT(refusal(setup, bad), HasSubstr("'md'"));
    EXPECT_EQ(refusal(setup, good), "accepted");
}

// Rounding of each cell and step is independent: the mean drifts by about
// eps · sqrt(steps/cells) · rms, here 6e-8 · sqrt(2000/1024); 40 times that is allowed.
TEST(FieldIntegrator, MassIsConservedUpToRounding) {
    for (const FieldScheme scheme : schemes) {
        for (const bool twofold : {false, true}) {
            FieldSetup setup = plane(32, 32, scheme, 0.05);
            setup.twofold = twofold;
            const auto fields = make_integrator(setup, 1);
            const double before = fields->mass(0);
            fields->advance(2000);
            const double mean = (fields->mass(0) - before) / setup.lattice.volume();
            const double eps = twofold ? 1.1e-16 : 6e-8;
            EXPECT_LT(std::abs(mean), 40 * eps * std::sqrt(2000.0 / 1024))
                << static_cast<int>(scheme);
        }
    }
}

TEST(FieldIntegrator, ReplicasShareTheOrderFieldAndNothingElse) {
    FieldSetup setup = plane(16, 16, FieldScheme::lod, 0.5);
    setup.replicas = 3;
    const auto three = make_integrator(setup, 1);
    setup.replicas = 1;
    const auto one = make_integrator(setup, 1);
    three->advance(5);
    one->advance(5);
    EXPECT_EQ(three->density(0).value, one->density(0).value);
    EXPECT_EQ(three->order().value, one->order().value);
    EXPECT_NE(three->density(1).value, three->density(0).value);
    EXPECT_NE(three->density(2).value, three->density(1).value);
}

TEST(FieldIntegrator, TheExplicitSchemeNamesItsBound) {
    const auto text = [](const FieldSetup& setup) -> std::string {
        try {
            make_integrator(setup, 1);
        } catch (const OptionError& error) {
            return error.what();
        }
        return "accepted";
    };
    EXPECT_THAT(text(plane(8, 8, FieldScheme::explicit_lm, 0.11)), HasSubstr("0.1056"));
    EXPECT_EQ(text(plane(8, 8, FieldScheme::explicit_lm, 0.105)), "accepted");
    EXPECT_THAT(text(line(8, FieldScheme::explicit_lm, 0.032)), HasSubstr("0.03125"));
}

TEST(FieldIntegrator, WithoutLambdaThereIsNoOrderField) {
    FieldSetup setup = plane(16, 16, FieldScheme::lod, 0.5);
    setup.model.lambda = 0;
    setup.has_order = false;
    const auto fields = make_integrator(setup, 1);
    fields->advance(10);
    EXPECT_EQ(fields->mean_diffusivity(), 1);
    for (const double psi : fields->order().value) EXPECT_EQ(psi, 0);
    // The same density as with ψ so small that D stays D0 to the last bit.
    setup.has_order = true;
    setup.model.lambda = 1e-30;
    const auto with = make_integrator(setup, 1);
    with->advance(10);
    EXPECT_EQ(with->density(0).value, fields->density(0).value);
}

}  // namespace
}  // namespace grainfield::simulate
