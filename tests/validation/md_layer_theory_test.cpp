// The vibrated layer against independent figures and balances.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "simulate/md/engine/engine_choice.h"
#include "simulate/md/md_simulation.h"
#include "simulate/md/state/initial_state.h"

namespace grainfield::simulate {

namespace {

class Nowhere : public SnapshotSink {
 public:
    void write(const Snapshot&) override {}
};

MdOptions layer(double amplitude, double periods) {
    MdOptions o;
    o.vibration.amplitude = amplitude;
    o.run.periods = periods;
    o.run.discard = periods + 1;
    return o;
}

double mean(const MdSeries& series, const char* column, std::size_t first) {
    const auto& values = series.curve().find(column)->values;
    double sum = 0;
    for (std::size_t i = first; i < values.size(); ++i) sum += values[i];
    return sum / static_cast<double>(values.size() - first);
}

}  // namespace

// Events over N and period of an independent code (fluid state, disordered start, 100 periods
// discarded, 100 averaged): ±4 %. The same run holds the energy audit (1e-10 over 1e7 events), the
// depth of all contacts and the balance of momentum: the plates carry N m g.
TEST(MdLayerTheory, ReproducesTheEventRatesOfAnIndependentCode) {
    struct Reference {
        double amplitude, pair, low, high;
    };
    for (const Reference& r :
         {Reference{0.06, 4.42, 1.73, 0.82}, Reference{0.08, 5.12, 1.88, 1.08},
          Reference{0.092, 5.49, 1.97, 1.20}, Reference{0.10, 5.69, 1.99, 1.27}}) {
        SCOPED_TRACE(r.amplitude);
        const MdOptions options = layer(r.amplitude, 200);
        RunPlan plan;
        MdSimulation simulation(options, make_initial_state(options, 1), 1, plan);
        Nowhere sink;
        while (!simulation.is_done()) simulation.run_window(sink);
        const MdSeries& series = simulation.series();
        EXPECT_NEAR(mean(series, "pair", 101) / r.pair, 1, 0.04);
        EXPECT_NEAR(mean(series, "low_plate", 101) / r.low, 1, 0.04);
        EXPECT_NEAR(mean(series, "high_plate", 101) / r.high, 1, 0.04);
        EXPECT_GT(simulation.events(), 10'000'000);
        EXPECT_LT(simulation.energy_audit(), 1e-10);
        EXPECT_LT(simulation.max_overlap(), 1e-12);
        EXPECT_LT(simulation.max_penetration(), 1e-12);
        EXPECT_LT(simulation.backwards(), 1e-12);
        // Force per grain: low − high = m g; the rest is the change of momentum, < sqrt(T/N)/time.
        EXPECT_NEAR(mean(series, "impulse_low", 101) - mean(series, "impulse_high", 101), 1, 1e-3);
    }
}

// ⟨v_z²⟩ = 0.56 and ⟨v_x²⟩ = 0.33 g a of an independent code, averaged over the phase (both depend
// on it), 100 periods discarded and 100 averaged: ±4 %.
TEST(MdLayerTheory, TemperaturesAveragedOverThePhase) {
    const MdOptions options = layer(0.08, 200);
    const MdSystem system = options.system();
    GrainState state = make_initial_state(options, 1);
    const auto engine = make_engine(system, {});
    const double period = system.period();
    double sum = 0;
    double horizontal = 0;
    constexpr int phases = 16;
    constexpr int discarded = 100;
    constexpr int averaged = 100;
    for (int w = 0; w < discarded + averaged; ++w) {
        engine->load(state, period);
        for (int k = 1; k <= phases; ++k) {
            engine->advance(period * k / phases);
            if (w < discarded) continue;
            const Energies e = engine->energies(period * k / phases);
            sum += 2 * e.vertical;
            horizontal += e.horizontal;
        }
        engine->store(period, state);
    }
    const double count = averaged * phases * static_cast<double>(state.size());
    EXPECT_NEAR(sum / count / 0.56, 1, 0.04);
    EXPECT_NEAR(horizontal / count / 0.33, 1, 0.04);
}

// Without friction nothing takes horizontal energy out but restitution: ⟨v_x²⟩ rises to about 1.5
// (last 100 of 400 periods).
TEST(MdLayerTheory, FrictionlessGrainsAreHotter) {
    MdOptions options = layer(0.08, 400);
    options.cell.grains = 2469;
    options.cell.length_x = options.cell.length_y = 50;
    options.grain.static_friction = options.grain.dynamic_friction = 0;
    options.plate.static_friction = options.plate.dynamic_friction = 0;
    RunPlan plan;
    MdSimulation simulation(options, make_initial_state(options, 1), 1, plan);
    Nowhere sink;
    while (!simulation.is_done()) simulation.run_window(sink);
    EXPECT_NEAR(mean(simulation.series(), "energy_xy", 301), 1.5, 0.2);
}

}  // namespace grainfield::simulate
