// Hard-sphere gases against closed forms.
#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "simulate/md/engine/engine_choice.h"
#include "simulate/md/state/initial_state.h"

namespace grainfield::simulate {

namespace {

constexpr double packing = 0.3;

MdOptions gas(std::int64_t grains, double eta) {
    MdOptions o;
    o.cell.grains = grains;
    o.cell.length_x = o.cell.length_y = o.cell.height =
        std::cbrt(static_cast<double>(grains) * std::numbers::pi / (6 * eta));
    o.cell.vertical = Vertical::periodic;
    o.cell.gravity = 0;
    o.vibration.amplitude = 0;
    o.grain = o.plate = {1, -1, 0, 0};
    o.initial.temperature = 1;
    return o;
}

struct Sums {
    double pairs = 0;
    double virial = 0;
};

Sums run(Engine& engine, GrainState& state, int windows, double window) {
    Sums sums;
    for (int i = 0; i < windows; ++i) {
        engine.load(state, window);
        engine.advance(window);
        engine.store(window, state);
        sums.pairs += static_cast<double>(engine.ledger().pair);
        sums.virial += engine.ledger().pair_virial.value();
    }
    return sums;
}

double temperature(const Engine& engine, double time, std::size_t grains) {
    const Energies e = engine.energies(time);
    return 2 * (e.horizontal + e.vertical) / (3 * static_cast<double>(grains));
}

double contact_value(double eta) {
    return (1 - eta / 2) / std::pow(1 - eta, 3);  // Carnahan–Starling
}

}  // namespace

// Carnahan–Starling and Enskog agree with simulations to 0.3 %; 6e5 collisions make the statistical
// error of both sums below 0.1 %, so ±0.5 % is five standard errors above the known difference.
TEST(MdGasTheory, PressureAndCollisionRateOfElasticSpheres) {
    for (const double eta : {0.1, 0.3, 0.45}) {
        const MdOptions options = gas(4000, eta);
        GrainState state = make_initial_state(options, 1);
        const auto engine = make_engine(options.system(), {});
        run(*engine, state, 5, 1);
        const double before = temperature(*engine, 1, state.size());
        const int windows = eta < 0.2 ? 120 : 30;
        const Sums sums = run(*engine, state, windows, 1);
        const auto n = static_cast<double>(state.size());
        const double t = temperature(*engine, 1, state.size());
        EXPECT_NEAR(t / before, 1, 1e-15 * sums.pairs);  // rounding: 1e-9 in 1e6 collisions
        const double z = 1 + sums.virial / (3 * n * t * windows);
        const double expected_z = (1 + eta + eta * eta - eta * eta * eta) / std::pow(1 - eta, 3);
        EXPECT_NEAR(z / expected_z, 1, 0.005) << eta;
        const double density = 6 * eta / std::numbers::pi;
        const double enskog = 4 * std::sqrt(std::numbers::pi * t) * density * contact_value(eta);
        EXPECT_NEAR(2 * sums.pairs / (n * windows) / enskog, 1, 0.005) << eta;
        Vec3 momentum;
        for (const Vec3& v : state.velocity) momentum += v;
        EXPECT_LT(norm(momentum), 1e-9);
    }
}

// Mean number of grains in the eighths of the box over 100 snapshots. A snapshot scatters by
// sqrt(500 · 7/8 · S(0)) = 6.5, S(0) = 0.098 at this packing; density waves take 4 sqrt(m a²/T) to
// cross the box, so 25 snapshots count: 1.3. Bound: 8 of them, 2 %.
TEST(MdGasTheory, TheGasFillsItsBoxUniformly) {
    const MdOptions options = gas(4000, packing);
    GrainState state = make_initial_state(options, 2);
    const auto engine = make_engine(options.system(), {});
    run(*engine, state, 10, 1);
    std::array<int, 8> count{};
    const double half = options.cell.height / 2;
    constexpr int snapshots = 100;
    for (int i = 0; i < snapshots; ++i) {
        run(*engine, state, 1, 1);
        for (const Vec3& r : state.position) {
            const int k = (r.x < half ? 0 : 1) + (r.y < half ? 0 : 2) + (r.z < half ? 0 : 4);
            ++count[static_cast<std::size_t>(k)];
        }
    }
    for (const int c : count) EXPECT_NEAR(static_cast<double>(c) / snapshots, 500, 8 * 1.3);
}

// Lyapunov instability multiplies rounding by e a few times per collision and grain: 2 collisions
// per grain there and back leave 1e-8.
TEST(MdGasTheory, ElasticMotionIsReversible) {
    const MdOptions options = gas(500, packing);
    const GrainState first = make_initial_state(options, 3);
    GrainState state = first;
    const auto engine = make_engine(options.system(), {});
    constexpr double window = 0.15;
    const Sums there = run(*engine, state, 1, window);
    EXPECT_GT(there.pairs, 300);
    for (Vec3& v : state.velocity) v = -1.0 * v;
    run(*engine, state, 1, window);
    const double length = options.cell.height;
    for (std::size_t i = 0; i < state.size(); ++i) {
        Vec3 d = state.position[i] - first.position[i];
        d.x -= length * std::round(d.x / length);
        d.y -= length * std::round(d.y / length);
        d.z -= length * std::round(d.z / length);
        EXPECT_LT(norm(d), 1e-8);
        EXPECT_LT(norm(state.velocity[i] + first.velocity[i]), 1e-7);
    }
}

// Haff: d ln T / dC = −(1 − e²)/3 per collision per grain, where C counts both partners'
// collisions; the Maxwellian value; molecular chaos corrections are O(1 − e²) below 1 % at e =
// 0.98.
TEST(MdGasTheory, InelasticGasCoolsByHaffsLaw) {
    MdOptions options = gas(8000, 0.2);
    options.grain.restitution = 0.98;
    GrainState state = make_initial_state(options, 4);
    const auto engine = make_engine(options.system(), {});
    run(*engine, state, 1, 0.5);
    const double before = temperature(*engine, 0.5, state.size());
    const Sums sums = run(*engine, state, 6, 1);
    const double after = temperature(*engine, 1, state.size());
    const double per_grain = 2 * sums.pairs / static_cast<double>(state.size());
    const double expected = -(1 - 0.98 * 0.98) / 3;
    EXPECT_NEAR(std::log(after / before) / per_grain / expected, 1, 0.03);
}

// Perfectly rough spheres, e = β0 = 1: equipartition at conserved energy; the ratio of the two
// energies fluctuates by ~sqrt(4/(3N)) = 1.6 %; 6 of them.
TEST(MdGasTheory, PerfectlyRoughSpheresShareTheirEnergyEqually) {
    MdOptions options = gas(5000, packing);
    options.grain = {1, 1, 1e9, 1e9};
    options.plate = options.grain;
    GrainState state = make_initial_state(options, 5);
    const auto engine = make_engine(options.system(), {});
    engine->load(state, 1);
    const double total = engine->energies(0).total();
    run(*engine, state, 30, 1);
    const Energies e = engine->energies(1);
    EXPECT_NEAR(e.total() / total, 1, 1e-11);
    EXPECT_NEAR(e.rotational / (e.horizontal + e.vertical), 1, 0.1);
}

// A column of elastic spheres over a floor at rest, dilute enough for n ∝ exp(−m g z / T) high up:
// mean height of grains above z0 exceeds z0 by T/g. The density above 10 a is below 0.003.
TEST(MdGasTheory, AnElasticColumnIsBarometric) {
    MdOptions options;
    options.cell.grains = 600;
    options.cell.length_x = options.cell.length_y = 20;
    options.cell.height = 400;
    options.vibration.amplitude = 0;
    options.grain = options.plate = {1, -1, 0, 0};
    options.initial.temperature = 10;
    options.initial.melt = 0;
    MdOptions low = options;
    low.cell.height = 40;
    GrainState state = make_initial_state(low, 6);  // starts low, then expands under the high lid
    const auto engine = make_engine(options.system(), {});
    run(*engine, state, 10, 20);
    double excess = 0;
    double count = 0;
    double kinetic = 0;
    for (int i = 0; i < 400; ++i) {
        run(*engine, state, 1, 10);
        const Energies e = engine->energies(10);
        kinetic += e.horizontal + e.vertical;
        for (const Vec3& r : state.position) {
            if (r.z < 25) continue;
            excess += r.z - 25;
            count += 1;
        }
    }
    const double t = 2 * kinetic / (3.0 * 600 * 400);
    EXPECT_GT(count, 10000);
    EXPECT_NEAR(excess / count / t, 1, 0.05);
}

}  // namespace grainfield::simulate
