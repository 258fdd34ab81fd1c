// Grains that touch, rest, collapse or are thrown: what lies between events.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "simulate/md/engine/event_engine.h"
#include "tests/simulate/md/engine/engine_scenes.h"
#include "tests/simulate/md/engine/reference_engine.h"

namespace grainfield::simulate {

TEST(EngineContacts, TouchingGrainsAtRestStayAtRest) {
    MdOptions options = layer(2, 5, 5);
    options.cell.gravity = 0;
    options.vibration.amplitude = 0;
    GrainState state = make_initial_state(options, 1);
    state.position = {{1, 1, 0.9}, {2, 1, 0.9}};
    state.velocity = {{}, {}};
    const auto engine = make_engine(options.system(), {});
    run(*engine, state, 1, 3);
    EXPECT_EQ(engine->ledger().pair, 0);
    EXPECT_EQ(state.position[1], (Vec3{2, 1, 0.9}));
}

TEST(EngineContacts, AChainOfTouchingGrainsPassesItsMomentumOn) {
    MdOptions options = layer(5, 20, 5);
    options.cell.gravity = 0;
    options.vibration.amplitude = 0;
    options.grain = {1, -1, 0, 0};
    options.plate = {1, -1, 0, 0};
    GrainState state = make_initial_state(options, 1);
    for (std::size_t i = 0; i < 5; ++i) {
        state.position[i] = {3.0 + static_cast<double>(i), 2, 0.9};
        state.velocity[i] = {};
    }
    state.position[0].x = 2.5;
    state.velocity[0] = {1, 0, 0};
    const auto engine = make_engine(options.system(), {});
    run(*engine, state, 2, 1);
    EXPECT_EQ(engine->ledger().pair, 4);
    EXPECT_NEAR(state.velocity[4].x, 1, 1e-14);
    EXPECT_NEAR(state.velocity[0].x, 0, 1e-14);
}

TEST(EngineContacts, ReportsInelasticCollapseWithPairAndTime) {
    MdOptions options = layer(1, 5, 5);
    options.vibration.amplitude = 0;
    options.plate.restitution = 0.5;
    GrainState state = make_initial_state(options, 1);
    EngineOptions o;
    o.event_limit = 10000;
    const auto engine = make_engine(options.system(), o);
    engine->load(state, 50);
    try {
        engine->advance(50);
        FAIL() << "a grain that comes to rest was not reported";
    } catch (const PhysicsError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("grain 0"));
        EXPECT_THAT(error.what(), testing::HasSubstr("low plate"));
        EXPECT_THAT(error.what(), testing::HasSubstr("set run.contact-time"));
    }
}

TEST(EngineContacts, TheReportOfACollapseKnowsWhetherTheContactTimeModelIsOn) {
    MdOptions options = layer(1, 5, 5);
    options.vibration.amplitude = 0;
    options.plate.restitution = 0.5;
    options.run.contact_time = 1e-6;
    EngineOptions o;
    o.event_limit = 10000;
    GrainState state = make_initial_state(options, 1);
    const auto engine = make_engine(options.system(), o);
    engine->load(state, 50);
    try {
        engine->advance(50);
        FAIL();
    } catch (const PhysicsError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("is 1e-06: make it longer"));
    }
}

TEST(EngineContacts, TheContactTimeModelCarriesThroughCollapse) {
    MdOptions options = layer(200, 15, 15);
    options.vibration.amplitude = 0;
    options.grain.restitution = options.plate.restitution = 0.5;
    options.run.contact_time = 1e-3;
    GrainState state = make_initial_state(options, 1);
    const auto engine = make_engine(options.system(), {});
    run(*engine, state, 1, 30);
    EXPECT_GT(engine->ledger().contact_time, 0);
    EXPECT_LT(engine->energies(1).vertical, 1e-2);
    EXPECT_LT(engine->max_overlap(), 1e-12);
}

namespace {

MdOptions one_heavy_grain(double amplitude) {
    MdOptions options = layer(1, 5, 5);
    options.cell.height = 4;
    options.vibration.amplitude = amplitude;
    options.plate.restitution = 0;
    options.run.contact_time = 1e-3;
    return options;
}

GrainState at_rest_on_the_plate(const MdOptions& options) {
    GrainState state = make_initial_state(options, 1);
    state.position = {{2, 2, 0.5}};
    state.velocity = {{0, 0, options.system().amplitude * 5}};
    return state;
}

}  // namespace

// Aω² = 0.75 g. Hops are at most v²/2(g + z̈), v = ½ (g + Aω²) t_c: 1.5e-6 a. The plate carries m g.
TEST(EngineContacts, AGrainRestsOnAPlateThatAcceleratesLessThanGravity) {
    const MdOptions options = one_heavy_grain(0.03);
    const MdSystem system = options.system();
    const double period = system.period();
    GrainState state = at_rest_on_the_plate(options);
    GrainState now;
    const auto engine = make_engine(system, {});
    double impulse = 0;
    double highest = 0;
    for (int w = 0; w < 50; ++w) {
        engine->load(state, period);
        for (int k = 1; k <= 16; ++k) {
            engine->advance(period * k / 16);
            engine->store(period * k / 16, now);
            const double gap = now.position[0].z - 0.5 - 0.03 * std::sin(5 * period * k / 16);
            highest = std::max(highest, gap);
            EXPECT_GT(gap, -1e-13);
        }
        engine->store(period, state);
        impulse += engine->ledger().low_impulse.value();
        EXPECT_GT(engine->ledger().resting, 0);
        EXPECT_LT(engine->ledger().low_plate, 2000);
    }
    EXPECT_LT(highest, 2e-6);
    EXPECT_NEAR(impulse / (50 * period), 1, 1e-3);
}

// Aω² = 2.25 g: it leaves where sin ωt = g/Aω² and flies the parabola of that instant; landing
// takes its whole relative speed.
TEST(EngineContacts, AGrainLeavesThePlateWhereItFallsFasterThanGravity) {
    const MdOptions options = one_heavy_grain(0.09);
    const MdSystem system = options.system();
    GrainState state = at_rest_on_the_plate(options);
    const auto engine = make_engine(system, {});
    engine->load(state, system.period());
    const double leaves = std::asin(1 / 2.25) / 5;
    const double z = 0.5 + 0.09 / 2.25;
    const double v = 0.45 * std::cos(5 * leaves);
    GrainState now;
    engine->advance(0.9 * leaves);
    engine->store(0.9 * leaves, now);
    EXPECT_NEAR(now.position[0].z, 0.5 + 0.09 * std::sin(4.5 * leaves), 1e-5);
    for (const double tau : {0.1, 0.3, 0.5}) {
        engine->advance(leaves + tau);
        engine->store(leaves + tau, now);
        EXPECT_NEAR(now.position[0].z, z + v * tau - 0.5 * tau * tau, 1e-3) << tau;
    }
    run(*engine, state, system.period(), 50);
    EXPECT_GT(engine->ledger().low_plate, 0);
    EXPECT_LT(engine->ledger().low_plate, 2000);
}

// On a plate at rest as well, and the balance of energy closes.
TEST(EngineContacts, AGrainThatDoesNotBounceComesToRest) {
    MdOptions options = one_heavy_grain(0);
    const MdSystem system = options.system();
    GrainState state = at_rest_on_the_plate(options);
    state.position[0].z = 1.5;
    const auto engine = make_engine(system, {});
    engine->load(state, 5);
    const double before = engine->energies(0).total();
    engine->advance(5);
    EXPECT_GT(engine->ledger().resting, 0);
    EXPECT_LT(engine->energies(5).vertical, 1e-6);
    EXPECT_NEAR(engine->energies(5).total() + engine->ledger().plate_loss.value(), before, 1e-12);
}

TEST(EngineContacts, TheDepthOfContactsIsThatOfRounding) {
    const MdOptions options = layer(880, 30, 30);
    GrainState state = start(options);
    const auto engine = make_engine(options.system(), {});
    run(*engine, state, options.system().period(), 3);
    EXPECT_GT(engine->ledger().deepest_pair.depth, 0) << "contacts are rounded";
    EXPECT_LT(engine->ledger().deepest_pair.depth, 1e-13);
    EXPECT_LT(engine->ledger().deepest_plate.depth, 1e-14);
    state.position[1] = state.position[0];
    state.position[1].x += 0.9;
    state.velocity[0].x = 5;
    state.velocity[1].x = -5;
    engine->load(state, options.system().period());
    engine->advance(0.01);
    EXPECT_GT(engine->ledger().deepest_pair.depth, 0.18) << "1 - 0.9² at the contact";
    EXPECT_EQ(engine->ledger().deepest_pair.first + engine->ledger().deepest_pair.second, 1);
}

TEST(EngineContacts, AStrongShakeIsSurvived) {
    MdOptions options = layer(500, 30, 30);
    options.vibration.amplitude = 3;
    options.vibration.angular_frequency = 40;
    const MdSystem system = options.system();
    GrainState state = make_initial_state(options, 1);
    const auto engine = make_engine(system, {});
    for (int window = 0; window < 30; ++window) {
        run(*engine, state, system.period(), 1);
        EXPECT_LT(engine->ledger().deepest_pair.depth, 1e-12);
        EXPECT_LT(engine->ledger().deepest_plate.depth, 1e-12);
        EXPECT_LT(engine->max_overlap(), 1e-12);
    }
    EXPECT_GT(engine->energies(system.period()).vertical, 500);
}

// The low plate carries all grains above the highest cells, where a cell has no upper end: more
// grains in one cell than fit between two plates. Periodic, every block of cells wraps; between
// walls, the blocks hold more candidates than there is room for at once.
void throw_a_column(Side sides) {
    MdOptions options = layer(170, 3, 3);
    options.cell.sides_x = options.cell.sides_y = sides;
    options.cell.height = 40;
    options.vibration.amplitude = 60;
    options.vibration.angular_frequency = 1;
    options.initial.melt = 0;
    const MdSystem system = options.system();
    GrainState state = start(options);
    constexpr double end = 1;  // the low plate is at 50
    ReferenceEngine reference(system, state, end);
    while (reference.step()) ASSERT_LT(reference.collisions(), 100000);
    const auto engine = make_engine(system, {});
    engine->load(state, end);
    engine->advance(end);
    EXPECT_EQ(engine->ledger().real_events(), reference.collisions());
    engine->store(end, state);
    for (std::size_t i = 0; i < state.size(); ++i) {
        ASSERT_GT(state.position[i].z, 40) << "all in the cells at the top";
        ASSERT_EQ(state.velocity[i], reference.velocity(i, end)) << i;
    }
    EXPECT_GT(state.size(), 4 * CellGrid::most_in_cell);
}

TEST(EngineContacts, AThrownColumnIsNotCutAtTheTopOfTheCells) {
    throw_a_column(Side::periodic);
}

TEST(EngineContacts, AThrownColumnBetweenWallsIsNotCutEither) {
    throw_a_column(Side::walls);
}

TEST(EngineContacts, AHotGasIsNoCollapse) {
    MdOptions options = layer(60, 5, 5);
    options.cell.vertical = Vertical::periodic;
    options.cell.gravity = 0;
    options.vibration.amplitude = 0;
    options.cell.height = 5;
    options.grain = options.plate = {1, -1, 0, 0};
    options.initial.temperature = 1e9;
    options.initial.melt = 5;
    GrainState state = start(options);
    EngineOptions o;
    o.event_limit = 1000;
    const auto engine = make_engine(options.system(), o);
    engine->load(state, 1);
    engine->advance(0.01);
    EXPECT_GT(engine->ledger().pair, 60 * 1000);
}

}  // namespace grainfield::simulate
