#include "simulate/md/engine/event_engine.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/support/random.h"
#include "simulate/md/engine/engine_choice.h"
#include "simulate/md/state/initial_state.h"
#include "tests/simulate/md/engine/reference_engine.h"

namespace grainfield::simulate {

namespace {

MdOptions layer(std::int64_t grains, double x, double y) {
    MdOptions o;
    o.cell.grains = grains;
    o.cell.length_x = x;
    o.cell.length_y = y;
    return o;
}

GrainState start(const MdOptions& options) {
    GrainState state = make_initial_state(options, 7);
    RandomStream random(3, "spins");
    for (Vec3& w : state.spin) w = {random.normal(), random.normal(), random.normal()};
    return state;
}

void run(Engine& engine, GrainState& state, double window, int windows) {
    for (int i = 0; i < windows; ++i) {
        engine.load(state, window);
        engine.advance(window);
        engine.store(window, state);
    }
}

bool same_bits(const GrainState& a, const GrainState& b) {
    const auto same = [](const std::vector<Vec3>& x, const std::vector<Vec3>& y) {
        return x.size() == y.size() &&
               std::memcmp(x.data(), y.data(), x.size() * sizeof(Vec3)) == 0;
    };
    return same(a.position, b.position) && same(a.velocity, b.velocity) && same(a.spin, b.spin);
}

struct Scene {
    const char* name;
    MdOptions options;
};

std::vector<Scene> scenes() {
    std::vector<Scene> all;
    all.push_back({"periodic layer", layer(55, 8, 7.5)});
    MdOptions walls = layer(40, 7, 8.3);
    walls.cell.sides_x = Side::walls;
    walls.cell.sides_y = Side::walls;
    walls.plate.static_friction = 0.4;
    all.push_back({"walled layer", walls});
    all.push_back({"two cells", layer(4, 2.5, 2.2)});
    MdOptions mixed = layer(20, 2.9, 9);
    mixed.cell.sides_y = Side::walls;
    all.push_back({"narrow channel", mixed});
    MdOptions still = layer(50, 8, 8);
    still.vibration.amplitude = 0;
    still.grain.restitution = still.plate.restitution = 1;
    all.push_back({"static plates", still});
    MdOptions tall = layer(60, 5, 5);
    tall.cell.height = 6.5;
    tall.vibration.amplitude = 0.2;
    all.push_back({"tall box", tall});
    MdOptions floating = layer(50, 8, 8);
    floating.cell.gravity = 0;
    floating.vibration.amplitude = 0;
    all.push_back({"no gravity", floating});
    MdOptions gas = layer(60, 4.3, 4.3);
    gas.cell.height = 4.3;
    gas.cell.vertical = Vertical::periodic;
    gas.cell.gravity = 0;
    gas.vibration.amplitude = 0;
    gas.initial.melt = 5;
    all.push_back({"rough gas", gas});
    MdOptions weightless = layer(50, 8, 8);
    weightless.cell.gravity = 0;
    all.push_back({"vibrating plates without gravity", weightless});
    MdOptions sticking = layer(50, 8, 8);
    sticking.grain.static_friction = sticking.grain.dynamic_friction = 1e9;
    sticking.plate = sticking.grain;
    all.push_back({"always sticking", sticking});
    MdOptions tiny = gas;
    tiny.cell.grains = 5;
    tiny.cell.length_x = tiny.cell.length_y = tiny.cell.height = 2.2;
    all.push_back({"box of two diameters", tiny});
    return all;
}

}  // namespace

TEST(EventEngine, FollowsTheReferenceEventByEventBitByBit) {
    for (const Scene& scene : scenes()) {
        SCOPED_TRACE(scene.name);
        const MdSystem system = scene.options.system();
        GrainState state = start(scene.options);
        const auto engine = make_engine(system, {});
        const double window = system.period();
        std::int64_t collisions = 0;
        for (int w = 0; w < 4; ++w) {
            ReferenceEngine reference(system, state, window);
            while (reference.step()) ASSERT_LT(reference.collisions(), 100000);
            engine->load(state, window);
            engine->advance(0.3 * window);  // pauses do not matter
            engine->advance(window);
            ASSERT_EQ(engine->ledger().real_events(), reference.collisions());
            collisions += reference.collisions();
            engine->store(window, state);
            for (std::size_t i = 0; i < state.size(); ++i) {
                ASSERT_EQ(state.velocity[i], reference.velocity(i, window)) << i;
                ASSERT_EQ(state.spin[i], reference.spin(i)) << i;
            }
        }
        EXPECT_GT(collisions, 10);
    }
}

TEST(EventEngine, GivesTheSameBitsForAnyThreadsAndTiles) {
    const MdOptions plain = layer(3900, 20, 200);
    MdOptions walled = plain;
    walled.cell.sides_x = walled.cell.sides_y = Side::walls;
    walled.plate.static_friction = 0.4;
    MdOptions smooth = plain;
    smooth.grain.static_friction = smooth.grain.dynamic_friction = 0;
    smooth.plate.static_friction = smooth.plate.dynamic_friction = 0;
    MdOptions contact_time = plain;
    contact_time.run.contact_time = 1e-3;
    contact_time.grain.restitution = 0.9;
    MdOptions tall = layer(3900, 8, 200);
    tall.cell.height = 6.5;
    tall.initial.melt = 2;
    for (const Scene& scene :
         {Scene{"periodic", plain}, Scene{"side walls", walled}, Scene{"smooth", smooth},
          Scene{"TC model", contact_time}, Scene{"tall", tall}}) {
        SCOPED_TRACE(scene.name);
        const MdSystem system = scene.options.system();
        const GrainState first = start(scene.options);
        GrainState expected = first;
        Ledger ledger;
        {
            const auto engine = make_engine(system, {});
            run(*engine, expected, system.period(), 3);
            ledger = engine->ledger();
        }
        EXPECT_LT(ledger.backwards, 1e-12) << "no event before the one before it";
        for (const auto& [threads, tiles] :
             {std::pair{1, 2}, {1, 3}, {1, 5}, {2, 0}, {2, 4}, {8, 5}}) {
            SCOPED_TRACE(std::to_string(threads) + " threads, " + std::to_string(tiles) + " tiles");
            EngineOptions o;
            o.threads = threads;
            o.tiles = tiles;
            const auto engine = make_engine(system, o);
            EXPECT_GT(engine->strips(), 1);
            GrainState state = first;
            run(*engine, state, system.period(), 3);
            EXPECT_LT(engine->fallbacks(), 3) << "no window was done in strips";
            EXPECT_TRUE(same_bits(state, expected));
            EXPECT_EQ(state.last_contact, expected.last_contact);
            EXPECT_EQ(engine->ledger().pair, ledger.pair);
            EXPECT_EQ(engine->ledger().low_plate, ledger.low_plate);
            EXPECT_EQ(engine->ledger().contact_time, ledger.contact_time);
            EXPECT_EQ(engine->ledger().pair_loss.value(), ledger.pair_loss.value());
            EXPECT_EQ(engine->ledger().work.value(), ledger.work.value());
        }
    }
}

TEST(EventEngine, ASecondThreadIsTakenOnlyWhereItsStripIsWorthIt) {
    EngineOptions o;
    o.threads = 2;
    EXPECT_EQ(make_engine(layer(9875, 100, 100).system(), o)->strips(), 1);
    EXPECT_EQ(make_engine(layer(9875, 50, 200).system(), o)->strips(), 2);
    o.threads = 1;
    EXPECT_EQ(make_engine(layer(9875, 50, 200).system(), o)->strips(), 1);
}

TEST(EventEngine, GivesTheSameBitsForTilesOfAGas) {
    MdOptions options = layer(4000, 8, 100);
    options.cell.height = 8;
    options.cell.vertical = Vertical::periodic;
    options.cell.gravity = 0;
    options.vibration.amplitude = 0;
    options.initial.melt = 2;
    const MdSystem system = options.system();
    const GrainState first = start(options);
    GrainState expected = first;
    run(*make_engine(system, {}), expected, 1, 2);
    EngineOptions o;
    o.tiles = 2;
    o.threads = 2;
    GrainState state = first;
    const auto engine = make_engine(system, o);
    run(*engine, state, 1, 2);
    EXPECT_LT(engine->fallbacks(), 2);
    EXPECT_TRUE(same_bits(state, expected));
}

// What is left out for a scene that does not need it changes nothing. Sticking: no bit. Smooth: the
// general engine turns grains by the rounding of n × n, 1e-17 a collision, which chaos multiplies:
// some collisions a grain leave 1e-13.
TEST(EventEngine, EveryPolicyFollowsTheGeneralOne) {
    for (const double friction : {0.0, 1e9}) {
        SCOPED_TRACE(friction);
        for (const bool tall : {false, true}) {
            MdOptions options = layer(220, 15, 15);
            if (tall) options.cell.height = 4;
            options.grain.static_friction = options.grain.dynamic_friction = friction;
            options.plate = options.grain;
            const MdSystem system = options.system();
            GrainState special = start(options);
            const bool is_smooth = friction == 0;
            if (is_smooth) std::fill(special.spin.begin(), special.spin.end(), Vec3{});
            GrainState general = special;
            const auto chosen = make_engine(system, {});
            const auto coulomb = make_event_engine<Tangential::coulomb>(system, {});
            EXPECT_TRUE(chosen->policies().starts_with(is_smooth ? "smooth" : "sticking"));
            EXPECT_TRUE(coulomb->policies().starts_with("Coulomb"));
            run(*chosen, special, system.period(), is_smooth ? 1 : 4);
            run(*coulomb, general, system.period(), is_smooth ? 1 : 4);
            EXPECT_GT(chosen->ledger().pair, 200);
            EXPECT_EQ(chosen->ledger().real_events(), coulomb->ledger().real_events());
            if (is_smooth) {
                for (std::size_t i = 0; i < special.size(); ++i) {
                    EXPECT_LT(norm(special.position[i] - general.position[i]), 1e-10);
                    EXPECT_LT(norm(special.velocity[i] - general.velocity[i]), 1e-10);
                    EXPECT_LT(norm(general.spin[i]), 1e-13);
                }
            } else {
                EXPECT_TRUE(same_bits(special, general));
                EXPECT_EQ(chosen->ledger().pair_loss.value(), coulomb->ledger().pair_loss.value());
            }
        }
    }
}

// Cold grains between plates that throw them at twice the plate's speed, the front's bound.
TEST(EventEngine, AGrainFasterThanTheFrontIsCaughtAndTheWindowDoneAgain) {
    MdOptions options = layer(3900, 20, 200);
    options.initial.temperature = 1e-6;
    const MdSystem system = options.system();
    const GrainState first = make_initial_state(options, 7);
    GrainState expected = first;
    run(*make_engine(system, {}), expected, system.period(), 2);
    EngineOptions o;
    o.tiles = 3;
    o.threads = 2;
    const auto engine = make_engine(system, o);
    GrainState state = first;
    run(*engine, state, system.period(), 2);
    EXPECT_GT(engine->fallbacks(), 0);
    EXPECT_TRUE(same_bits(state, expected));
}

TEST(EventEngine, DoesNotDependOnTheOrderInMemory) {
    const MdOptions options = layer(900, 31, 30);
    const MdSystem system = options.system();
    GrainState plain = start(options);
    GrainState sorted = plain;
    sort_in_space(sorted);
    const auto engine = make_engine(system, {});
    run(*engine, plain, system.period(), 2);
    run(*engine, sorted, system.period(), 2);
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        ASSERT_EQ(sorted.position[i], plain.position[static_cast<std::size_t>(sorted.id[i])]);
    }
}

// Contacts are exact to rounding: positions near 30 a carry 4e-15.
TEST(EventEngine, NeitherOverlapsNorPenetratesBeyondRounding) {
    const MdOptions options = layer(880, 30, 30);
    const MdSystem system = options.system();
    GrainState state = start(options);
    const auto engine = make_engine(system, {});
    const double period = system.period();
    double deepest = 0;
    for (int w = 0; w < 10; ++w) {
        engine->load(state, period);
        for (const double phase : {0.11, 0.37, 0.62, 0.93, 1.0}) {
            engine->advance(phase * period);
            engine->store(phase * period, state);
            const double plate = 0.08 * std::sin(5 * phase * period);
            for (std::size_t i = 0; i < state.size(); ++i) {
                const Vec3& r = state.position[i];
                deepest = std::max({deepest, plate + 0.5 - r.z, r.z + 0.5 - 1.84 - plate});
                for (std::size_t j = 0; j < i; ++j) {
                    Vec3 d = state.position[j] - r;
                    d.x -= 30 * std::round(d.x / 30);
                    d.y -= 30 * std::round(d.y / 30);
                    deepest = std::max(deepest, 1 - norm(d));
                }
            }
        }
    }
    EXPECT_LT(deepest, 1e-13);
}

TEST(EventEngine, NoneOneAndTwoGrains) {
    for (const std::int64_t grains : {0, 1, 2}) {
        const MdOptions options = layer(grains, 3, 3);
        const MdSystem system = options.system();
        GrainState state = make_initial_state(options, 1);
        ASSERT_EQ(state.size(), static_cast<std::size_t>(grains));
        run(*make_engine(system, {}), state, system.period(), 20);
        for (const Vec3& r : state.position) {
            EXPECT_GT(r.z, 0.5 - 1e-12);
            EXPECT_LT(r.z, 1.34 + 1e-12);
        }
    }
}

// The grid needs two cells on each periodic axis.
TEST(EventEngine, RefusesPeriodicBoxesOfTwoDiameters) {
    for (const auto member : {&CellOptions::length_x, &CellOptions::length_y}) {
        MdOptions options = layer(2, 5, 5);
        options.cell.*member = 2;
        try {
            options.system();
            FAIL() << "one cell on a periodic axis";
        } catch (const OptionError& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr("2.000001"));
        }
        options.cell.*member = 2.00001;
        GrainState state = make_initial_state(options, 1);
        EngineOptions o;
        o.threads = o.tiles = 2;
        run(*make_engine(options.system(), o), state, options.system().period(), 5);
    }
    MdOptions gas = layer(2, 5, 5);
    gas.cell.vertical = Vertical::periodic;
    gas.cell.gravity = gas.vibration.amplitude = 0;
    gas.cell.height = 2;
    EXPECT_THROW(gas.system(), OptionError);
}

TEST(EventEngine, TouchingGrainsAtRestStayAtRest) {
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

TEST(EventEngine, AChainOfTouchingGrainsPassesItsMomentumOn) {
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

TEST(EventEngine, ReportsInelasticCollapseWithPairAndTime) {
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

TEST(EventEngine, TheReportOfACollapseKnowsWhetherTheContactTimeModelIsOn) {
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

TEST(EventEngine, TheContactTimeModelCarriesThroughCollapse) {
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
    state.velocity = {{0, 0, options.vibration.amplitude * 5}};
    return state;
}

}  // namespace

// Aω² = 0.75 g. Hops are at most v²/2(g + z̈), v = ½ (g + Aω²) t_c: 1.5e-6 a. The plate carries m g.
TEST(EventEngine, AGrainRestsOnAPlateThatAcceleratesLessThanGravity) {
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
TEST(EventEngine, AGrainLeavesThePlateWhereItFallsFasterThanGravity) {
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
TEST(EventEngine, AGrainThatDoesNotBounceComesToRest) {
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

TEST(EventEngine, TheDepthOfContactsIsThatOfRounding) {
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

TEST(EventEngine, AStrongShakeIsSurvived) {
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
// grains in one cell than fit between two plates.
TEST(EventEngine, AThrownColumnIsNotCutAtTheTopOfTheCells) {
    MdOptions options = layer(170, 3, 3);
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
        ASSERT_GT(state.position[i].z, 40) << "all in the four cells at the top";
        ASSERT_EQ(state.velocity[i], reference.velocity(i, end)) << i;
    }
    EXPECT_GT(state.size(), 4 * CellGrid::most_in_cell);
}

TEST(EventEngine, AHotGasIsNoCollapse) {
    MdOptions options = layer(60, 5, 5);
    options.cell.vertical = Vertical::periodic;
    options.cell.gravity = options.vibration.amplitude = 0;
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
