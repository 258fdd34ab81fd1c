// Inelastic collapse: what it is reported by, in every regime, and how the TC model avoids it.
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "simulate/md/engine/engine_choice.h"
#include "simulate/md/state/initial_state.h"

namespace grainfield::simulate {

namespace {

MdOptions layer(double grain_restitution, double plate_restitution) {
    MdOptions o;
    o.cell.grains = 60;
    o.cell.length_x = o.cell.length_y = 8;
    o.grain.restitution = grain_restitution;
    o.plate.restitution = plate_restitution;
    return o;
}

struct Regime {
    std::string name;
    MdOptions options;
    double contact_time = 1e-4;  ///< that carries it through
    bool is_soon = true;         ///< collapses in the time of the test below
};

std::vector<Regime> regimes() {
    std::vector<Regime> all{{"nothing bounces", layer(0, 0)},
                            {"grains do not bounce", layer(0, 0.9)},
                            {"little bounces", layer(0.1, 0.1)},
                            {"plates do not bounce", layer(0.998, 0)}};
    MdOptions heavy = layer(0.998, 0.998);
    heavy.cell.gravity = 1e5;
    all.push_back({"strong gravity", heavy});
    heavy.cell.gravity = 1e6;
    all.push_back({"stronger gravity", heavy});
    MdOptions still = layer(0.9, 0.9);
    still.vibration.amplitude = 0;
    all.push_back({"plates at rest", still});
    still.grain.restitution = still.plate.restitution = 0.999;
    all.push_back({"nearly elastic", still, 1e-4, false});
    MdOptions slow = layer(0.8, 0.8);
    slow.vibration.angular_frequency = 1e-3;
    slow.vibration.amplitude = 1;
    all.push_back({"slow plates", slow});
    MdOptions gas = layer(0.1, 0.1);
    gas.cell = {.grains = 300, .length_x = 8, .length_y = 8, .height = 8};
    gas.cell.vertical = Vertical::periodic;
    gas.cell.gravity = 0;
    gas.vibration.amplitude = 0;
    all.push_back({"gas without gravity", gas});
    gas.initial.temperature = 1e9;
    all.push_back({"hot gas", gas, 1e-8});
    return all;
}

constexpr double window = 20;

// Why it failed; empty if it did not.
std::string failure(Engine& engine, const GrainState& state, int windows = 1) {
    GrainState now = state;
    try {
        for (int i = 0; i < windows; ++i) {
            engine.load(now, window);
            engine.advance(window);
            engine.store(window, now);
        }
    } catch (const PhysicsError& error) {
        return error.what();
    }
    return {};
}

}  // namespace

// At the default limit of a million events a grain.
TEST(Collapse, IsReportedInEveryRegimeWithGrainTimeAndRemedy) {
    for (const Regime& regime : regimes()) {
        const GrainState state = make_initial_state(regime.options, 1);
        const auto engine = make_engine(regime.options.system(), {});
        EXPECT_THAT(failure(*engine, state, 500),
                    testing::MatchesRegex(
                        "inelastic collapse: grain [0-9]+ collides without end with (grain "
                        "[0-9]+|the low plate): [0-9]+ events .* time [0-9.e-]+ of the window; "
                        "set run.contact-time .*"))
            << regime.name;
    }
}

// The energy is audited; 2e4 hops of a contact time each are below the limit.
TEST(Collapse, TheContactTimeModelCarriesThroughEveryRegime) {
    for (Regime& regime : regimes()) {
        MdOptions& options = regime.options;
        options.run.contact_time = regime.contact_time;
        const MdSystem system = options.system();
        GrainState state = make_initial_state(options, 1);
        const auto engine = make_engine(system, {});
        const double end = system.is_vibrating() ? std::min(2 * system.period(), 5.0) : 2;
        engine->load(state, end);
        const double before = engine->energies(0).total();
        ASSERT_NO_THROW(engine->advance(end)) << regime.name;
        const Ledger& ledger = engine->ledger();
        const double change = engine->energies(end).total() - before;
        const double losses = ledger.pair_loss.value() + ledger.plate_loss.value();
        const double scale = std::abs(before) + std::abs(ledger.work.value());
        EXPECT_NEAR(change, ledger.work.value() - losses, 1e-10 * scale) << regime.name;
        EXPECT_EQ(ledger.contact_time > 0, regime.is_soon) << regime.name;
        EXPECT_LT(engine->max_overlap(), 1e-12) << regime.name;
    }
}

// Where two collapse in different strips, threads would report either.
TEST(Collapse, TheReportIsTheSameForAnyNumberOfStrips) {
    MdOptions options = layer(0.3, 0.3);
    options.cell = {.grains = 1500, .length_x = 8, .length_y = 250};
    const GrainState state = make_initial_state(options, 1);
    std::vector<std::string> reports;
    for (const int tiles : {1, 2, 4}) {
        EngineOptions o;
        o.threads = 2;
        o.tiles = tiles;
        const auto engine = make_engine(options.system(), o);
        reports.push_back(failure(*engine, state));
        EXPECT_EQ(engine->strips(), tiles);
    }
    EXPECT_THAT(reports[0], testing::HasSubstr("inelastic collapse"));
    EXPECT_THAT(reports, testing::Each(reports[0]));
}

// A contact time may be so short that a run would take for ever: known long before the limit.
TEST(Collapse, APaceThatWouldExceedTheLimitIsReportedAtOnce) {
    MdOptions options = layer(0.998, 0);
    options.run.contact_time = 1e-7;
    const GrainState state = make_initial_state(options, 1);
    const auto engine = make_engine(options.system(), {});
    engine->load(state, window);
    std::string report;
    double reached = 0;
    try {
        for (reached = 0.01; reached < window; reached += 0.01) engine->advance(reached);
    } catch (const PhysicsError& error) {
        report = error.what();
    }
    EXPECT_THAT(report, testing::HasSubstr("is 1e-07: make it longer"));
    EXPECT_LT(static_cast<double>(engine->ledger().real_events()), 3e6) << reached;
}

// Elastic grains that touch share impulses in a few events: no collapse, whatever the spacing.
TEST(Collapse, ContactsAtOneInstantAreNoCollapse) {
    MdOptions options = layer(1, 1);
    options.cell.gravity = 0;
    options.vibration.amplitude = 0;
    options.cell.grains = 7;
    options.cell.height = 2;
    GrainState state = make_initial_state(options, 1);
    for (std::size_t i = 0; i < 7; ++i) {
        state.position[i] = {0.5 + static_cast<double>(i), 4, 1};
        state.velocity[i] = {i == 0 ? 1.0 : 0.0, 0, 0};
    }
    const auto engine = make_engine(options.system(), {});
    EXPECT_EQ(failure(*engine, state, 10), "");
}

}  // namespace grainfield::simulate
