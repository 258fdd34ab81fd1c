#include "simulate/md/md_simulation.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "simulate/md/engine/engine_choice.h"
#include "simulate/md/state/initial_state.h"

namespace grainfield::simulate {

namespace {

class Collector : public SnapshotSink {
 public:
    void write(const Snapshot& snapshot) override { snapshots.push_back(snapshot); }
    std::vector<Snapshot> snapshots;
};

MdOptions small() {
    MdOptions o;
    o.cell.grains = 400;
    o.cell.length_x = o.cell.length_y = 20.5;
    o.run.periods = 60;
    o.run.discard = 3;
    o.run.snapshot_every = 2.4;
    o.run.snapshot_phase = 0.16;
    return o;
}

MdSimulation make(const MdOptions& options, RunPlan& plan) {
    return {options, make_initial_state(options, 1), 1, plan};
}

}  // namespace

TEST(MdSimulation, GivesSnapshotsAtTheTimesAskedFor) {
    const MdOptions options = small();
    RunPlan plan;
    MdSimulation simulation = make(options, plan);
    Collector sink;
    while (!simulation.is_done()) simulation.run_window(sink);
    const double period = options.system().period();
    ASSERT_EQ(sink.snapshots.size(), 24U);
    for (std::size_t i = 0; i < sink.snapshots.size(); ++i) {
        const Snapshot& s = sink.snapshots[i];
        EXPECT_NEAR(s.time, (3.16 + 2.4 * static_cast<double>(i)) * period, 1e-10);
        EXPECT_EQ(s.frame, static_cast<std::int64_t>(i));
        EXPECT_NO_THROW(require_consistent(s));
        for (std::size_t k = 0; k < s.size(); ++k) {
            EXPECT_TRUE(s.box.contains(s.position[k]));
            EXPECT_EQ(s.id[k], static_cast<std::int64_t>(k));
        }
    }
    EXPECT_EQ(simulation.series().size(), 61U);
}

TEST(MdSimulation, GoesOnFromACheckpointBitByBit) {
    MdOptions options = small();
    options.run.contact_time = 1e-6;
    RunPlan plan;
    MdSimulation whole = make(options, plan);
    MdSimulation first = make(options, plan);
    Collector expected;
    Collector resumed;
    while (!whole.is_done()) whole.run_window(expected);
    for (int i = 0; i < 3; ++i) first.run_window(resumed);
    MdSimulation second(options, {}, 2, plan);
    second.restore(first.checkpoint());
    while (!second.is_done()) second.run_window(resumed);
    ASSERT_EQ(resumed.snapshots.size(), expected.snapshots.size());
    for (std::size_t i = 0; i < expected.snapshots.size(); ++i) {
        EXPECT_EQ(resumed.snapshots[i].position, expected.snapshots[i].position);
        EXPECT_EQ(resumed.snapshots[i].velocity, expected.snapshots[i].velocity);
        EXPECT_EQ(resumed.snapshots[i].spin, expected.snapshots[i].spin);
        EXPECT_EQ(resumed.snapshots[i].frame, expected.snapshots[i].frame);
    }
    const Curve& a = whole.series().curve();
    const Curve& b = second.series().curve();
    for (std::size_t c = 0; c < a.columns.size(); ++c) {
        for (std::size_t k = 0; k < a.columns[c].values.size(); ++k) {
            ASSERT_EQ(a.columns[c].values[k], b.columns[c].values[k]) << a.columns[c].name << k;
        }
    }
    EXPECT_EQ(whole.events(), second.events());
}

TEST(MdSimulation, MayEndLaterOrSoonerThanTheCheckpointWasMadeFor) {
    MdOptions options = small();
    RunPlan plan;
    MdSimulation shorter = make(options, plan);
    Collector resumed;
    for (int i = 0; i < 3; ++i) shorter.run_window(resumed);
    ASSERT_FALSE(shorter.is_done());

    MdOptions longer = options;
    longer.run.periods += 7;
    MdSimulation whole = make(longer, plan);
    Collector expected;
    while (!whole.is_done()) whole.run_window(expected);
    MdSimulation second(longer, {}, 2, plan);
    second.restore(shorter.checkpoint());
    while (!second.is_done()) second.run_window(resumed);
    ASSERT_EQ(resumed.snapshots.size(), expected.snapshots.size());
    EXPECT_EQ(resumed.snapshots.back().position, expected.snapshots.back().position);

    MdOptions now = options;
    now.run.periods = shorter.periods_done();
    MdSimulation ended(now, {}, 2, plan);
    ended.restore(shorter.checkpoint());
    EXPECT_TRUE(ended.is_done());
    now.run.periods -= 1;
    MdSimulation before(now, {}, 2, plan);
    EXPECT_THROW(before.restore(shorter.checkpoint()), InputError);
}

TEST(MdSimulation, IsNotLengthenedWhereItsLastWindowWasCutShort) {
    MdOptions options = small();
    options.run.periods += 0.5;
    RunPlan plan;
    MdSimulation done = make(options, plan);
    Collector sink;
    while (!done.is_done()) done.run_window(sink);
    MdSimulation same(options, {}, 2, plan);
    same.restore(done.checkpoint());
    EXPECT_TRUE(same.is_done());
    options.run.periods += 10;
    MdSimulation longer(options, {}, 2, plan);
    EXPECT_THROW(longer.restore(done.checkpoint()), InputError);
}

// As after a collapse. Where the model is new, collisions before are not remembered.
TEST(MdSimulation, GoesOnWithAContactTimeThatTheCheckpointHadNotAndWithout) {
    MdOptions with = small();
    with.run.contact_time = 1e-3;
    for (const bool begins_with : {false, true}) {
        RunPlan plan;
        Collector sink;
        MdSimulation first = make(begins_with ? with : small(), plan);
        first.run_window(sink);
        MdSimulation second(begins_with ? small() : with, {}, 1, plan);
        second.restore(first.checkpoint());
        const Checkpoint taken_up = second.checkpoint();
        EXPECT_EQ(taken_up.reals.at("position"), first.checkpoint().reals.at("position"));
        const auto& last = taken_up.reals.at("last_contact");
        EXPECT_EQ(last.size(), begins_with ? 0U : taken_up.integers.at("id").size());
        for (const double time : last) EXPECT_EQ(time, no_contact_yet);
        while (!second.is_done()) second.run_window(sink);
    }
}

TEST(MdSimulation, RefusesACheckpointThatLacksSomething) {
    const MdOptions options = small();
    RunPlan plan;
    MdSimulation simulation = make(options, plan);
    Checkpoint checkpoint = simulation.checkpoint();
    checkpoint.reals.erase("velocity");
    EXPECT_THROW(simulation.restore(checkpoint), InputError);
}

TEST(MdSimulation, RefusesACheckpointWithNonsenseAndNamesTheFile) {
    MdOptions options = small();
    options.run.contact_time = 1e-6;
    RunPlan plan;
    MdSimulation simulation = make(options, plan);
    Collector sink;
    simulation.run_window(sink);
    const Checkpoint good = simulation.checkpoint();
    EXPECT_NO_THROW(simulation.restore(good, "'a.checkpoint'"));
    const auto refusal = [&](auto&& damage) {
        Checkpoint bad = good;
        damage(bad);
        try {
            simulation.restore(bad, "'a.checkpoint'");
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    for (const auto& [name, numbers] : good.reals) {
        const std::string text =
            refusal([&key = name](Checkpoint& c) { c.reals[key].front() = NAN; });
        EXPECT_THAT(text, testing::HasSubstr("'a.checkpoint': '" + name + "'"));
        const std::string shorter =
            refusal([&key = name](Checkpoint& c) { c.reals[key].pop_back(); });
        EXPECT_THAT(shorter, testing::HasSubstr("'" + name + "'"));
    }
    EXPECT_THAT(refusal([](Checkpoint& c) { c.integers["id"][3] = 4; }),
                testing::HasSubstr("4 twice"));
    EXPECT_THAT(refusal([](Checkpoint& c) { c.integers["id"][3] = -1; }),
                testing::HasSubstr("'id'"));
    EXPECT_THAT(refusal([](Checkpoint& c) { c.integers["id"].pop_back(); }),
                testing::HasSubstr("'id'"));
    EXPECT_THAT(refusal([](Checkpoint& c) { ++c.integers["progress"][2]; }),
                testing::HasSubstr("'series'"));
    EXPECT_THAT(refusal([](Checkpoint& c) { c.integers["progress"][0] = -1; }),
                testing::HasSubstr("'progress'"));
}

// Kinetic part over 8 phases, collisional part over the same period.
TEST(MdSimulation, ThePressureIsTheMeanOfThePeriod) {
    MdOptions options = small();
    options.run.periods = 3;
    RunPlan plan;
    MdSimulation simulation = make(options, plan);
    Collector sink;
    while (!simulation.is_done()) simulation.run_window(sink);
    const MdSystem system = options.system();
    const GrainState state = make_initial_state(options, 1);
    const auto engine = make_engine(system, {});
    engine->load(state, 3 * system.period());
    const auto& measured = simulation.series().curve().find("pressure")->values;
    double virial = 0;
    for (std::size_t period = 0; period < 3; ++period) {
        double kinetic = 0;
        for (int k = 1; k <= 8; ++k) {
            const double time = (static_cast<double>(period) + k / 8.0) * system.period();
            engine->advance(time);
            const Energies e = engine->energies(time);
            kinetic += (e.horizontal + e.vertical) / 8;
        }
        const double exchanged = engine->ledger().pair_virial.value() - virial;
        virial += exchanged;
        const double expected =
            (2 * kinetic + exchanged / system.period()) / (3 * 20.5 * 20.5 * options.cell.height);
        EXPECT_NEAR(measured.at(period + 1) / expected, 1, 1e-9);
    }
}

// Carnahan–Starling at φ = 0.45; 300 grains, some 1e4 collisions and more: 5 % are five standard
// errors. A period of the hot gas adds a virial of 2e7.
TEST(MdSimulation, ThePressureHoldsAtAnyTemperature) {
    for (const double temperature : {1e-4, 1.0, 3e3}) {
        MdOptions options;
        options.cell.grains = 300;
        options.cell.length_x = options.cell.length_y = options.cell.height =
            std::cbrt(300 * 3.14159265358979 / (6 * 0.45));
        options.cell.vertical = Vertical::periodic;
        options.cell.gravity = 0;
        options.vibration.amplitude = 0;
        options.grain = options.plate = {1, -1, 0, 0};
        options.initial.temperature = temperature;
        options.run.periods = temperature < 1 ? 400 : (temperature > 1 ? 1 : 20);
        RunPlan plan;
        MdSimulation simulation = make(options, plan);
        Collector sink;
        while (!simulation.is_done()) simulation.run_window(sink);
        const double eta = 0.45;
        const double z = (1 + eta + eta * eta - eta * eta * eta) / std::pow(1 - eta, 3);
        const double kinetic =
            simulation.series().late_mean("energy_xy") + simulation.series().late_mean("energy_z");
        const double density = 6 * eta / 3.14159265358979;
        EXPECT_NEAR(simulation.series().late_mean("pressure") / (density * kinetic * 2 / 3 * z), 1,
                    0.05)
            << temperature;
    }
}

TEST(MdSimulation, SaysWhichAccelerationDrivesIt) {
    MdOptions options = small();
    options.vibration.amplitude = 0.09;
    options.vibration.angular_frequency = 5;
    RunPlan plan;
    const auto control = make(options, plan).info().control;
    ASSERT_TRUE(control.has_value());
    EXPECT_EQ(control->parameter, ControlParameter::acceleration);
    EXPECT_DOUBLE_EQ(control->value, 2.25);
    MdSystem system = options.system();
    system.gravity = 0.5;
    EXPECT_DOUBLE_EQ(control_of(system)->value, 4.5);
    system.gravity = 0;
    EXPECT_FALSE(control_of(system).has_value());
}

TEST(MdSimulation, SaysWhatItSkips) {
    MdOptions options = small();
    options.grain.static_friction = options.grain.dynamic_friction = 0;
    options.plate.static_friction = options.plate.dynamic_friction = 0;
    options.vibration.amplitude = 0;
    RunPlan plan;
    const MdSimulation simulation = make(options, plan);
    EXPECT_EQ(simulation.policies(), "smooth, gravity, plates at rest");
    std::vector<std::string> skipped;
    for (const PlannedStage& stage : plan.skipped()) skipped.push_back(stage.stage);
    EXPECT_EQ(skipped.front(), "rotation");
    EXPECT_EQ(skipped.at(1), "sinusoidal plates");
}

TEST(MdSimulation, ADeepContactIsReportedWithPairAndTime) {
    Ledger ledger;
    EXPECT_NO_THROW(require_clean_contacts(ledger, 1e-12, 30, 2));
    ledger.deepest_pair = {1 - 0.9 * 0.9, 17, 4, 3};
    try {
        require_clean_contacts(ledger, 1e-12, 30, 2);
        FAIL();
    } catch (const PhysicsError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("grain 17 meets grain 4 at period 31.5"));
        EXPECT_THAT(error.what(), testing::HasSubstr("0.1 a deep"));
    }
    EXPECT_NO_THROW(require_clean_contacts(ledger, 0.11, 30, 2));
    ledger.deepest_plate = {0.2, 3, -1, 1};
    EXPECT_THROW(require_clean_contacts(ledger, 0.11, 30, 2), PhysicsError);
}

}  // namespace grainfield::simulate
