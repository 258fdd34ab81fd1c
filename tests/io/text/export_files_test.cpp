#include "io/text/export_files.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "io/text/points_csv.h"
#include "tests/io/file_samples.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::io {
namespace {

using ::testing::HasSubstr;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

class Snapshots : public SnapshotSource {
 public:
    explicit Snapshots(std::vector<Snapshot> snapshots) : snapshots_(std::move(snapshots)) {}
    const TrajectoryInfo& info() const override { return info_; }
    void set_info(TrajectoryInfo info) { info_ = std::move(info); }
    std::int64_t count() const override { return static_cast<std::int64_t>(snapshots_.size()); }
    Snapshot read(std::int64_t i) override { return snapshots_.at(static_cast<std::size_t>(i)); }

 private:
    TrajectoryInfo info_;
    std::vector<Snapshot> snapshots_;
};

std::string csv_of(std::vector<Snapshot> snapshots, Digits digits = Digits::all) {
    const testing::ScratchFolder folder;
    Snapshots source(std::move(snapshots));
    export_csv(source, folder / "x.csv", Overwrite::refuse, {.digits = digits});
    return read_bytes(folder / "x.csv");
}

std::string xyz_of(std::vector<Snapshot> snapshots) {
    const testing::ScratchFolder folder;
    Snapshots source(std::move(snapshots));
    export_xyz(source, folder / "x.xyz", Overwrite::refuse);
    return read_bytes(folder / "x.xyz");
}

Snapshot two_points(std::int64_t frame) {
    Snapshot s;
    s.frame = frame;
    s.time = 0.25;
    s.box = {{-0.5, 0}, {10, 20}, {Boundary::walls, Boundary::periodic}, 0};
    s.position = {{1.5, 2}, {0.1, -3}};
    return s;
}

TEST(ExportCsv, HasTheColumnsThatApplyInTheOrderOfTheContract) {
    Snapshot s = two_points(3);
    EXPECT_EQ(csv_of({s}), "frame,x,y\n3,1.5,2\n3,0.1,-3\n");
    s.id = {7, 8};
    s.z = {0.5, nan};
    s.position_error = {{0.01, 0.02}, {nan, nan}};
    s.z_error = {0.25, nan};
    s.layer = {Layer::top, Layer::unknown};
    s.quality = {0.125, nan};
    EXPECT_EQ(csv_of({s}),
              "frame,particle,x,y,z,x_std,y_std,z_std,layer,quality\n"
              "3,7,1.5,2,0.5,0.01,0.02,0.25,1,0.125\n"
              "3,8,0.1,-3,,,,,,\n");
}

TEST(ExportCsv, LeavesFieldsEmptyInFramesWithoutTheColumn) {
    Snapshot linked = two_points(0);
    linked.id = {1, 2};
    EXPECT_EQ(csv_of({linked, two_points(5)}),
              "frame,particle,x,y\n0,1,1.5,2\n0,2,0.1,-3\n5,,1.5,2\n5,,0.1,-3\n");
    EXPECT_EQ(csv_of({}), "frame,x,y\n");
}

TEST(ExportCsv, HasDigitsToATenthOfTheErrorAndAllWhereItIsUnknown) {
    Snapshot s = two_points(0);
    s.position = {{100.123456789, 0.123456789}, {1.0 / 3, 2}};
    s.position_error = {{0.13, 0.001}, {nan, 12.3456}};
    s.quality = {0.0512345, nan};
    EXPECT_EQ(csv_of({s}, Digits::as_errors),
              "frame,x,y,x_std,y_std,quality\n"
              "0,100.12,0.1235,0.13,0.001,0.05123\n"
              "0,0.3333333333333333,2,,12.3,\n");
    // The rounding is at most a twentieth of the error, which adds 0.05 % to it.
    std::vector<Snapshot> many{full_snapshot(0, 200)};
    const testing::ScratchFolder folder;
    Snapshots source(many);
    export_csv(source, folder / "x.csv", Overwrite::refuse);
    const auto points = open_points(folder / "x.csv", std::nullopt, {});
    const Snapshot read = points->read(0);
    bool is_rounded = false;
    for (std::size_t i = 0; i < 200; ++i) {
        const double error = many[0].position_error[i].x;
        const double off = std::abs(read.position[i].x - many[0].position[i].x);
        EXPECT_LE(off, 0.0501 * error) << i;
        is_rounded |= off > 0;
    }
    EXPECT_TRUE(is_rounded);
}

class ExportCsvStatement : public ::testing::TestWithParam<bool> {};

TEST_P(ExportCsvStatement, OfUnitsRateDiameterAndBoxIsReadBack) {
    const testing::ScratchFolder folder;
    const PointsForm form{.header = GetParam(), .digits = Digits::all};
    Snapshot empty = two_points(4);
    empty.position.clear();
    empty.time = 4 / 30.0;
    Snapshot late = two_points(6);
    late.time = 0.5;
    Snapshots source({two_points(3), empty, late});
    source.set_info({.origin = Origin::video,
                     .length_unit = LengthUnit::pixel,
                     .time_unit = TimeUnit::second,
                     .diameter = 10.0 / 3,
                     .vibration_frequency = 60,
                     .frame_rate = 30,
                     .source = "film.avi"});
    export_csv(source, folder / "x.csv", Overwrite::refuse, form);
    EXPECT_THAT(read_bytes(folder / (form.header ? "x.csv" : "x.csv.meta")),
                HasSubstr("\n# box: -0.5,0,10,20,0\n"));
    EXPECT_EQ(read_bytes(folder / "x.csv").starts_with("frame,x,y\n3,1.5,2\n"), !form.header);
    EXPECT_TRUE(states_box(folder / "x.csv"));
    const auto points = open_points(folder / "x.csv", std::nullopt, {});
    const TrajectoryInfo& info = points->info();
    EXPECT_EQ(info.origin, Origin::video);
    EXPECT_EQ(info.length_unit, LengthUnit::pixel);
    EXPECT_EQ(info.time_unit, TimeUnit::second);
    EXPECT_EQ(info.diameter, 10.0 / 3);
    EXPECT_EQ(info.frame_rate, 30);
    EXPECT_EQ(info.vibration_frequency, 60);
    ASSERT_EQ(points->count(), 3) << "a frame without particles is a frame";
    EXPECT_EQ(points->read(1).size(), 0U);
    EXPECT_EQ(points->read(0).time, 0.25) << "not frame / rate: as it was";
    EXPECT_EQ(points->read(1).time, 4 / 30.0);
    EXPECT_EQ(points->read(2).time, 0.5);
    const Box box = points->read(0).box;
    EXPECT_EQ(box.origin, (Vec2{-0.5, 0}));
    EXPECT_EQ(box.length, (Vec2{10, 20}));
    EXPECT_EQ(box.boundary[0], Boundary::walls);
    EXPECT_EQ(box.boundary[1], Boundary::periodic);
    const auto other = open_points(folder / "x.csv", Box{{0, 0}, {11, 21}}, {});
    EXPECT_EQ(other->read(0).box.length, (Vec2{11, 21})) << "what is asked for wins";
    EXPECT_EQ(other->read(0).box.boundary[1], Boundary::periodic);
    EXPECT_TRUE(states_diameter(folder / "x.csv"));
}

INSTANTIATE_TEST_SUITE_P(InTheTableOrBesideIt, ExportCsvStatement, ::testing::Bool());

TEST(ExportCsv, StatementOfTheTableItselfWinsOverAnOldOneBesideIt) {
    const testing::ScratchFolder folder;
    Snapshots source({two_points(0)});
    source.set_info({.diameter = 7, .vibration_frequency = {}, .frame_rate = {}, .source = ""});
    export_csv(source, folder / "x.csv", Overwrite::refuse);
    source.set_info({.diameter = 8, .vibration_frequency = {}, .frame_rate = {}, .source = ""});
    export_csv(source, folder / "x.csv", Overwrite::force, {.header = true});
    EXPECT_EQ(open_points(folder / "x.csv", std::nullopt, {})->info().diameter, 8);
}

TEST(ExportCsv, WithADamagedStatementBesideItIsRefusedByTheNameOfThatFile) {
    const testing::ScratchFolder folder;
    write_bytes(folder / "x.csv", "frame,x,y\n0,1,1\n");
    write_bytes(folder / "x.csv.meta", "# grainfield points 1\n# diameter: large\n");
    try {
        open_points(folder / "x.csv", std::nullopt, {});
        ADD_FAILURE() << "taken";
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("x.csv.meta', line 2"));
    }
}

TEST(ExportCsv, ReadsBackToTheSameBits) {
    const testing::ScratchFolder folder;
    std::vector<Snapshot> snapshots{full_snapshot(0, 200), full_snapshot(2, 150),
                                    plain_snapshot(3, 60)};
    Snapshots source(snapshots);
    export_csv(source, folder / "x.csv", Overwrite::refuse, {.digits = Digits::all});
    const auto points = open_points(folder / "x.csv", snapshots[0].box, with_frame_rate(30));
    ASSERT_EQ(points->count(), 3);
    for (std::size_t i = 0; i < snapshots.size(); ++i) {
        Snapshot expected = snapshots[i];
        // What a table of points has no column for.
        expected.velocity.clear();
        expected.spin.clear();
        expected.box = snapshots[0].box;
        expect_same(points->read(static_cast<std::int64_t>(i)), expected);
    }
}

TEST(ExportXyz, HasABlockPerFrameWithBoxTimeAndProperties) {
    Snapshot s = two_points(3);
    EXPECT_EQ(
        xyz_of({s}),
        "2\nLattice=\"10 0 0 0 20 0 0 0 1\" Origin=\"-0.5 0 0\" pbc=\"F T F\" frame=3 "
        "Time=0.25 Properties=species:S:1:pos:R:3:radius:R:1\nA 1.5 2 0 0.5\nA 0.1 -3 0 0.5\n");
    s.id = {7, 8};
    s.z = {0.5, 0.75};
    s.box.height = 1.7;
    s.velocity = {{1, 2, 3}, {nan, nan, nan}};
    s.position_error = {{0.1, 0.5}, {nan, nan}};
    s.quality = {nan, 2};
    EXPECT_EQ(
        xyz_of({s}),
        "2\nLattice=\"10 0 0 0 20 0 0 0 1.7\" Origin=\"-0.5 0 0\" pbc=\"F T F\" frame=3 "
        "Time=0.25 "
        "Properties=species:S:1:pos:R:3:radius:R:1:id:I:1:velo:R:3:position_error:R:3:quality:R:1\n"
        "A 1.50 2.00 0.5 0.5 7 1 2 3 0.1 0.5 nan nan\nA 0.1 -3 0.75 0.5 8 nan nan nan nan nan nan "
        "2\n");
}

TEST(ExportXyz, HasABlockOfZeroParticlesForAnEmptyFrame) {
    const std::string text = xyz_of({full_snapshot(0, 0), full_snapshot(1, 3)});
    EXPECT_TRUE(text.starts_with("0\nLattice="));
    EXPECT_EQ(std::ranges::count(text, '\n'), 2 + 2 + 3);
}

Results two_curves() {
    Results results;
    ObservableResult msd{
        .name = "msd", .measurements = {}, .curves = {}, .options = {}, .reason = {}, .seconds = 0};
    msd.curves.push_back({.name = "msd",
                          .title = "",
                          .columns = {{"t", "s", "", {0.5, 1}}, {"msd", "a^2", "", {2, nan}}},
                          .text_columns = {{"phase", {"liquid", "a, \"b\""}}}});
    msd.curves.push_back({.name = "empty", .title = "", .columns = {}, .text_columns = {}});
    results.observables.push_back(msd);
    return results;
}

TEST(ExportCurves, WritesOneTableForEachIntoANewFolder) {
    const testing::ScratchFolder folder;
    export_curves(two_curves(), folder / "new/curves", Overwrite::refuse);
    EXPECT_EQ(read_bytes(folder / "new/curves/msd.csv"),
              "t,phase,msd\n0.5,liquid,2\n1,\"a, \"\"b\"\"\",\n");
    EXPECT_EQ(read_bytes(folder / "new/curves/empty.csv"), "\n");
    EXPECT_EQ(read_bytes(folder / "new/curves/units.csv"),
              "curve,column,unit,meaning\nmsd,t,s,\nmsd,msd,a^2,\n");
}

TEST(ExportCurves, NamesTheTimeUnitOfTheRun) {
    const testing::ScratchFolder folder;
    Results results = two_curves();
    results.source.time_unit = TimeUnit::second;
    results.observables[0].curves[0].columns[0].unit = "time unit";
    results.observables[0].curves[0].columns[1].unit = "a^2/time unit";
    export_curves(results, folder.path(), Overwrite::refuse);
    EXPECT_EQ(read_bytes(folder / "units.csv"),
              "curve,column,unit,meaning\nmsd,t,s,\nmsd,msd,a^2/s,\n");
}

TEST(ExportCurves, WritesNothingIfOneOfTheFilesExists) {
    const testing::ScratchFolder folder;
    write_bytes(folder / "empty.csv", "mine");
    EXPECT_THROW(export_curves(two_curves(), folder.path(), Overwrite::refuse), OutputError);
    EXPECT_EQ(folder.entries(), 1U);
    EXPECT_EQ(read_bytes(folder / "empty.csv"), "mine");
    export_curves(two_curves(), folder.path(), Overwrite::force);
    EXPECT_EQ(folder.entries(), 3U);
}

TEST(ExportCurves, RefusesNamesThatLeadOutOfTheFolder) {
    const testing::ScratchFolder folder;
    for (const char* name : {"../x", "/x", "", ".", "a b", "x\n"}) {
        Results results = two_curves();
        results.observables[0].curves[0].name = name;
        EXPECT_THROW(export_curves(results, folder / "sub", Overwrite::force), InputError) << name;
    }
    Results twice = two_curves();
    twice.observables[0].curves[1].name = "msd";
    EXPECT_THROW(export_curves(twice, folder / "sub", Overwrite::force), InputError);
    EXPECT_EQ(folder.entries(), 0U);
}

TEST(ExportFiles, RefuseAnExistingTargetAndLeaveItAlone) {
    const testing::ScratchFolder folder;
    write_bytes(folder / "x", "mine");
    Snapshots source({two_points(0)});
    EXPECT_THROW(export_csv(source, folder / "x", Overwrite::refuse), OutputError);
    EXPECT_THROW(export_xyz(source, folder / "x", Overwrite::refuse), OutputError);
    EXPECT_THROW(export_curves(two_curves(), folder / "x", Overwrite::refuse), OutputError);
    EXPECT_EQ(read_bytes(folder / "x"), "mine");
    EXPECT_EQ(folder.entries(), 1U);
}

}  // namespace
}  // namespace grainfield::io
