#include "simulate/md/engine/event_engine.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/simulate/md/engine/engine_scenes.h"
#include "tests/simulate/md/engine/reference_engine.h"

namespace grainfield::simulate {

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

// 3e3 sqrt(a/g) into a window, times have 5e-13 between them.
TEST(EventEngine, WindowsOfTenPeriodsKeepTheDigitsThatOneWindowForTheWholeRunLoses) {
    const MdOptions options = layer(6, 3, 3);
    const MdSystem system = options.system();
    const double period = system.period();
    const auto engine = make_engine(system, {});
    const auto deepest = [&](double periods, int windows) {
        GrainState state = start(options);
        double depth = 0;
        for (int w = 0; w < windows; ++w) {
            run(*engine, state, periods * period, 1);
            const Ledger& ledger = engine->ledger();
            depth = std::max({depth, ledger.deepest_pair.depth / 2, ledger.deepest_plate.depth});
        }
        return depth;
    };
    EXPECT_GT(deepest(2500, 1), 1e-13);
    EXPECT_LT(deepest(10, 250), 1e-14);
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
    gas.cell.gravity = 0;
    gas.vibration.amplitude = 0;
    gas.cell.height = 2;
    EXPECT_THROW(gas.system(), OptionError);
}

}  // namespace grainfield::simulate
