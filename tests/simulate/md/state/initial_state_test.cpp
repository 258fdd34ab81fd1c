#include "simulate/md/state/initial_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "simulate/md/engine/engine_choice.h"

namespace grainfield::simulate {

namespace {

double overlap(const MdOptions& options, const GrainState& state) {
    const auto engine = make_engine(options.system(), {});
    engine->load(state, 0);
    return engine->max_overlap();
}

MdOptions cell(double fraction, double length, double height) {
    MdOptions o;
    o.cell.length_x = o.cell.length_y = length;
    o.cell.height = height;
    o.cell.grains = static_cast<std::int64_t>(fraction * 4 / 3.14159265358979 * length * length);
    return o;
}

}  // namespace

TEST(InitialState, FillsTheLayerUpToTheBilayerWithoutOverlap) {
    for (const double fraction : {0.1, 0.7756, 0.9192, 1.2, 1.5}) {
        for (const Side side : {Side::periodic, Side::walls}) {
            MdOptions options = cell(fraction, 30, 1.94);
            options.cell.sides_x = options.cell.sides_y = side;
            options.initial.melt = fraction > 0.78 ? 5 : 0;
            const GrainState state = make_initial_state(options, 1);
            EXPECT_EQ(state.size(), static_cast<std::size_t>(options.cell.grains));
            EXPECT_LT(overlap(options, state), 1e-12) << fraction;
        }
    }
}

TEST(InitialState, RefusesMoreGrainsThanFitAndSaysHowManyDo) {
    const MdOptions options = cell(1.6, 30, 1.94);
    try {
        make_initial_state(options, 1);
        FAIL();
    } catch (const OptionError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("cell.grains"));
        EXPECT_THAT(error.what(), testing::HasSubstr("at most"));
    }
}

TEST(InitialState, MakesASquarePatchInLiquid) {
    MdOptions options = cell(0.7756, 60, 1.84);
    options.initial.layout = InitialLayout::square;
    const GrainState state = make_initial_state(options, 1);
    EXPECT_EQ(state.size(), static_cast<std::size_t>(options.cell.grains));
    EXPECT_LT(overlap(options, state), 1e-12);
    options.initial.crystal_fraction = 0.95;
    EXPECT_THROW(make_initial_state(options, 1), OptionError);
}

TEST(InitialState, HasTheTemperatureAskedForAndNoDrift) {
    MdOptions options = cell(0.7756, 100, 1.84);
    options.initial.temperature = 0.7;
    const GrainState state = make_initial_state(options, 1);
    Vec3 sum;
    double square = 0;
    for (const Vec3& v : state.velocity) {
        sum += v;
        square += v.x * v.x;
    }
    const auto n = static_cast<double>(state.size());
    EXPECT_NEAR(sum.x, 0, 1e-9);
    EXPECT_NEAR(sum.y, 0, 1e-9);
    EXPECT_NEAR(square / n, 0.7, 5 * 0.7 * std::sqrt(2 / n));  // false alarm 6e-7
}

TEST(InitialState, DependsOnTheSeedAlone) {
    const MdOptions options = cell(0.9, 20, 1.94);
    EXPECT_EQ(make_initial_state(options, 5).position, make_initial_state(options, 5).position);
    EXPECT_NE(make_initial_state(options, 5).position, make_initial_state(options, 6).position);
}

TEST(InitialState, RestartsFromASnapshotButNotFromOverlaps) {
    const MdOptions options = cell(0.5, 20, 1.84);
    const GrainState state = make_initial_state(options, 1);
    Snapshot snapshot;
    snapshot.box = {{0, 0}, {20, 20}, {Boundary::periodic, Boundary::periodic}, 1.84};
    for (const Vec3& r : state.position) {
        snapshot.position.push_back({r.x, r.y});
        snapshot.z.push_back(r.z);
    }
    snapshot.velocity = state.velocity;
    EXPECT_EQ(state_of(snapshot, {}, options, 1).position, state.position);
    EXPECT_EQ(state_of(snapshot, {}, options, 1).velocity, state.velocity);
    snapshot.position[1] = snapshot.position[0];
    EXPECT_THROW(state_of(snapshot, {}, options, 1), InputError);
    snapshot.z.clear();
    EXPECT_THROW(state_of(snapshot, {}, options, 1), InputError);
}

TEST(InitialState, RefusesASnapshotOfAnotherCellOrPhase) {
    const MdOptions options = cell(0.5, 20, 1.84);
    const GrainState state = make_initial_state(options, 1);
    Snapshot snapshot;
    snapshot.box = {{0, 0}, {20, 20}, {Boundary::periodic, Boundary::periodic}, 1.84};
    for (const Vec3& r : state.position) {
        snapshot.position.push_back({r.x, r.y});
        snapshot.z.push_back(r.z);
    }
    TrajectoryInfo source;
    source.vibration_frequency = 1 / options.system().period();
    snapshot.time = 1e6 * options.system().period();
    EXPECT_NO_THROW(state_of(snapshot, source, options, 1));
    const auto refusal = [&](const MdOptions& o, const Snapshot& s) {
        try {
            state_of(s, source, o, 1);
        } catch (const OptionError& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    MdOptions other = options;
    other.cell.length_x = 100;
    EXPECT_THAT(refusal(other, snapshot), testing::HasSubstr("cell.length-x"));
    EXPECT_THAT(refusal(other, snapshot), testing::HasSubstr("20 a, as in the snapshot"));
    other = options;
    other.cell.height = 1.9;
    EXPECT_THAT(refusal(other, snapshot), testing::HasSubstr("cell.height"));
    other = options;
    other.cell.sides_y = Side::walls;
    EXPECT_THAT(refusal(other, snapshot), testing::HasSubstr("cell.sides-y"));
    other = options;
    ++other.cell.grains;
    EXPECT_THAT(refusal(other, snapshot), testing::HasSubstr("cell.grains"));
    Snapshot shifted = snapshot;
    shifted.time += 0.25 * options.system().period();
    EXPECT_THAT(refusal(options, shifted), testing::HasSubstr("phase 0.25"));
}

}  // namespace grainfield::simulate
