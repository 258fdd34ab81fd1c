#include "simulate/md/md_size.h"

#include <gtest/gtest.h>

#include "simulate/md/md_simulation.h"
#include "simulate/md/state/initial_state.h"

namespace grainfield::simulate {

namespace {

struct NoSink : SnapshotSink {
    void write(const Snapshot&) override {}
};

}  // namespace

// Beside the engine there are a snapshot and a checkpoint: about 1.5 times its bytes.
TEST(MdSize, IsThatOfARunWithinAFactorOfTwo) {
    MdOptions options;
    options.cell.grains = 20000;
    options.cell.length_x = options.cell.length_y = 150;
    options.run.periods = 2;
    RunPlan plan;
    MdSimulation simulation(options, make_initial_state(options, 1), 1, plan);
    NoSink sink;
    simulation.run_window(sink);
    const double bytes = 1.5 * static_cast<double>(simulation.bytes());
    EXPECT_GT(size_of(options).bytes, 0.5 * bytes);
    EXPECT_LT(size_of(options).bytes, 2 * bytes);
}

TEST(MdSize, GrowsWithEmptyPlacesAndSamplesToo) {
    MdOptions options;
    options.cell.grains = 10;
    options.cell.length_x = options.cell.length_y = 60000;
    EXPECT_GT(size_of(options).bytes, 3.6e9 * 24) << "each place of the layout";
    options.cell.length_x = options.cell.length_y = 10;
    options.run.periods = 1e9;
    EXPECT_GT(size_of(options).bytes, 1e11) << "a row of the series a period";
    options.run.sample_every = 1000;
    EXPECT_LT(size_of(options).bytes, 1e9);
    EXPECT_GT(size_of(options).seconds, 1e4);
}

}  // namespace grainfield::simulate
