#include "simulate/simulate.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield::simulate {
namespace {

MdOptions small_layer() {
    MdOptions options;
    options.cell.grains = 60;
    options.cell.length_x = options.cell.length_y = 10;
    options.run.periods = 12;
    options.run.discard = 4;
    options.run.snapshot_every = 2;
    return options;
}

TEST(SimulateMd, ReturnsTheSnapshotsThatWereAskedFor) {
    const Trajectory trajectory = simulate_md(small_layer());
    EXPECT_EQ(trajectory.info.origin, Origin::md);
    ASSERT_EQ(trajectory.snapshots.size(), 5U);  // periods 4, 6, 8, 10, 12
    const double period = 2 * M_PI / small_layer().system().angular_frequency;
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_EQ(trajectory.snapshots[i].size(), 60U);
        EXPECT_NEAR(trajectory.snapshots[i].time, (4 + 2 * static_cast<double>(i)) * period, 1e-9);
    }
}

TEST(SimulateMd, DependsOnTheSeedAndNotOnThreads) {
    const Trajectory one = simulate_md(small_layer(), {.seed = 3, .threads = 1});
    const Trajectory two = simulate_md(small_layer(), {.seed = 3, .threads = 2});
    const Trajectory other = simulate_md(small_layer(), {.seed = 4, .threads = 1});
    EXPECT_EQ(one.snapshots.back().position, two.snapshots.back().position);
    EXPECT_NE(one.snapshots.back().position, other.snapshots.back().position);
}

TEST(SimulateMd, SaysInThePlanWhatIsSkipped) {
    MdOptions options = small_layer();
    options.cell.gravity = 0;
    RunPlan plan;
    simulate_md(options, {.plan = &plan});
    EXPECT_TRUE(std::ranges::any_of(plan.skipped(),
                                    [](const PlannedStage& s) { return s.stage == "gravity"; }));
    options.cell.grains = 100000;
    EXPECT_THROW(simulate_md(options), OptionError);
}

FieldOptions small_fields() {
    FieldOptions options;
    options.lattice.nx = 16;
    options.record.relax = 20;
    options.record.record = 50;
    options.record.sample = 10;
    return options;
}

TEST(SimulateField, ReturnsOneInstantASampleOfConstantMass) {
    const std::vector<FieldFrame> frames = simulate_field(small_fields());
    ASSERT_EQ(frames.size(), 5U);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const DensityField& density = frames[i].density.front();
        EXPECT_NEAR(density.time, 20 + 10 * static_cast<double>(i + 1), 1e-9);
        EXPECT_EQ(density.size(), 256U);
        double largest = 0;
        for (const double rho : density.value) largest = std::max(largest, std::abs(rho));
        EXPECT_GT(largest, 0);
        const double mass = std::accumulate(density.value.begin(), density.value.end(), 0.0);
        EXPECT_LT(std::abs(mass), 256 * 1e-5 * largest);  // single precision, 140 steps
    }
    const auto again = simulate_field(small_fields(), {.threads = 2});
    EXPECT_EQ(again.back().density.front().value, frames.back().density.front().value);
}

TEST(SimulateField, RefusesTheSchemeThatHasNoDensity) {
    FieldOptions options = small_fields();
    options.scheme.scheme = SchemeChoice::adjoint;
    EXPECT_THROW(simulate_field(options), OptionError);
}

TEST(Render, MakesAFrameAndItsTruthOfEachSnapshot) {
    RenderOptions options;
    options.view.width = options.view.height = 120;
    options.exposure.drop_rate = 0.5;
    const Trajectory trajectory = simulate_md(small_layer());
    const RenderedFilm film = render(trajectory, options, {.seed = 2});
    ASSERT_EQ(film.frames.size(), trajectory.snapshots.size());
    const auto lost = std::ranges::count_if(
        film.frames, [](const Frame& f) { return f.status == FrameStatus::missing; });
    EXPECT_EQ(film.truth.snapshots.size() + static_cast<std::size_t>(lost), film.frames.size());
    EXPECT_EQ(film.truth.info.length_unit, LengthUnit::pixel);
    for (const Snapshot& truth : film.truth.snapshots) {
        EXPECT_GE(truth.size(), 55U);  // a jolt or a periodic border may hide some
        const Frame& frame = film.frames[static_cast<std::size_t>(truth.frame)];
        EXPECT_EQ(frame.image.width(), 120);
    }
    EXPECT_THROW(render({}, options), OptionError);
}

}  // namespace
}  // namespace grainfield::simulate
