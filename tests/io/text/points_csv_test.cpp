#include "io/text/points_csv.h"

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/io/file_samples.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::io {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::unique_ptr<SnapshotSource> open_text(const std::string& path, const std::string& text,
                                          const TrajectoryInfo& hints = {}) {
    write_bytes(path, text);
    return open_points(path, std::nullopt, hints);
}

void expect_refused(const std::string& text, const std::string& part) {
    const testing::ScratchFolder folder;
    EXPECT_THAT([&] { open_text(folder / "p.csv", text); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("p.csv"), HasSubstr(part))))
        << text;
}

TEST(PointsCsv, HasOneSnapshotPerFrameInOrderOfFrames) {
    const testing::ScratchFolder folder;
    const auto points = open_text(
        folder / "p.csv", "frame,particle,x,y\n7,2,1.5,2\n0,1,3,4\n7,9,5,6\n# remark\n\n7,1,7,8\n");
    ASSERT_EQ(points->count(), 2);
    const Snapshot first = points->read(0);
    EXPECT_EQ(first.frame, 0);
    EXPECT_THAT(first.position, ElementsAre(Vec2{3, 4}));
    const Snapshot second = points->read(1);
    EXPECT_EQ(second.frame, 7);
    EXPECT_EQ(second.time, 7);
    EXPECT_THAT(second.position, ElementsAre(Vec2{1.5, 2}, Vec2{5, 6}, Vec2{7, 8}));
    EXPECT_THAT(second.id, ElementsAre(2, 9, 1));
    EXPECT_EQ(points->info().source, "p.csv");
}

TEST(PointsCsv, RefusesAParticleThatStandsTwiceInAFrame) {
    expect_refused("frame,particle,x,y\n0,1,1,1\n0,2,2,2\n0,1,3,3\n", "line 4");
    expect_refused("frame,particle,x,y\n0,1,1,1\n0,1,3,3\n1,1,1,1\n", "line 3");
    const testing::ScratchFolder folder;
    // Lines in the order of particles: found when the frame is read.
    const auto scattered =
        open_text(folder / "s.csv", "frame,particle,x,y\n0,1,1,1\n1,1,2,2\n0,1,3,3\n");
    EXPECT_THAT([&] { scattered->read(0); }, ThrowsMessage<InputError>(HasSubstr("line 4")));
    EXPECT_EQ(scattered->read(1).size(), 1U);
}

TEST(PointsCsv, ReadsOnlyTheStatementsOfItsOwnComments) {
    const testing::ScratchFolder folder;
    const auto others =
        open_text(folder / "o.csv", "# diameter: large\nframe,x,y\n# box: 3\n0,1,1\n0,2,3\n");
    EXPECT_EQ(others->info().diameter, 1);
    EXPECT_FALSE(states_box(folder / "o.csv"));
    expect_refused("# grainfield points 1\n# diameter: large\nframe,x,y\n0,1,1\n", "line 2");
    expect_refused("# grainfield points 1\n# box: 0,0,nan,1,0\nframe,x,y\n0,1,1\n", "line 2");
    expect_refused("# grainfield points 1\n# boundary: walls,walls\nframe,x,y\n0,1,1\n", "line 2");
}

TEST(PointsCsv, TakesTablesOfOtherTrackers) {
    const testing::ScratchFolder folder;
    // trackpy: an index without a name, y before x, whole numbers as decimals, other columns.
    const auto trackpy = open_text(folder / "t.csv",
                                   "\xEF\xBB\xBF,y,x,mass,ep,frame\r\n0,10.5,20.25,300,,0.0\r\n"
                                   "1,1e1,+2,300,nan,1.0\r\n");
    ASSERT_EQ(trackpy->count(), 2);
    EXPECT_THAT(trackpy->read(0).position, ElementsAre(Vec2{20.25, 10.5}));
    EXPECT_THAT(trackpy->read(1).position, ElementsAre(Vec2{2, 10}));
    EXPECT_TRUE(trackpy->read(0).id.empty());
    const auto quoted =
        open_text(folder / "q.csv", "\"Frame\", X ,\"Y\",note\n0,\"1\", 2 ,\"a, b\"\n1,3,4,x");
    ASSERT_EQ(quoted->count(), 2);
    EXPECT_THAT(quoted->read(0).position, ElementsAre(Vec2{1, 2}));
    EXPECT_THAT(quoted->read(1).position, ElementsAre(Vec2{3, 4}));
}

TEST(PointsCsv, TakesTheUnitOfPositionsFromTheHeader) {
    const testing::ScratchFolder folder;
    TrajectoryInfo in_diameters;
    in_diameters.length_unit = LengthUnit::diameter;
    const auto points = open_text(folder / "p.csv",
                                  "frame,particle,X_px,y_px,kind\n0,4,1.5,2,black\n", in_diameters);
    EXPECT_THAT(points->read(0).position, ElementsAre(Vec2{1.5, 2}));
    EXPECT_EQ(points->info().length_unit, LengthUnit::pixel);
    expect_refused("frame,x_px,y\n0,1,2\n", "x,y or x_px,y_px");
    expect_refused("frame,x,x_px,y\n0,1,1,2\n", "'x' occurs twice");
}

TEST(PointsCsv, WithoutAFrameIsOneFrameOnlyWhereThatIsAllowed) {
    const testing::ScratchFolder folder;
    write_bytes(folder / "p.csv", "x,y,z,layer\n1,2,0.5,1\n3,4,1.5,2\n");
    EXPECT_THAT([&] { open_points(folder / "p.csv", std::nullopt, {}); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("no column 'frame'"),
                                                HasSubstr("columns frame,x,y (or x_px,y_px)"))));
    const auto points = open_points(folder / "p.csv", std::nullopt, {}, FrameColumn::optional);
    ASSERT_EQ(points->count(), 1);
    const Snapshot s = points->read(0);
    EXPECT_EQ(s.frame, 0);
    EXPECT_THAT(s.position, ElementsAre(Vec2{1, 2}, Vec2{3, 4}));
    EXPECT_THAT(s.layer, ElementsAre(Layer::bottom, Layer::top)) << "counted from 1";
}

TEST(PointsCsv, CountsLayersFromOneOnlyWhereTheTableDoes) {
    const testing::ScratchFolder folder;
    const auto layers = [&](const std::string& rows) {
        return open_text(folder / "p.csv", "frame,x,y,layer\n" + rows)->read(0).layer;
    };
    EXPECT_THAT(layers("0,1,2,0\n0,3,4,1\n"), ElementsAre(Layer::bottom, Layer::top));
    EXPECT_THAT(layers("0,1,2,1\n0,3,4,1\n"), ElementsAre(Layer::top, Layer::top));
    EXPECT_THAT(layers("0,1,2,0\n0,3,4,2\n"), ElementsAre(Layer::bottom, Layer::unknown));
}

TEST(PointsCsv, ReadsEveryColumnAndKeepsMissingNumbersMissing) {
    const testing::ScratchFolder folder;
    const auto points = open_text(folder / "p.csv",
                                  "frame,particle,x,y,z,x_std,y_std,z_std,layer,quality\n"
                                  "0,5,1,2,0.5,0.1,0.2,0.4,1,0.03\n"
                                  "0,6,3,4,,0.1,,,,\n"
                                  "1,,3,4,,,,,,\n");
    const Snapshot s = points->read(0);
    EXPECT_THAT(s.id, ElementsAre(5, 6));
    EXPECT_EQ(s.z[0], 0.5);
    EXPECT_TRUE(std::isnan(s.z[1]));
    EXPECT_EQ(s.position_error[0], (Vec2{0.1, 0.2}));
    EXPECT_TRUE(std::isnan(s.position_error[1].y));
    EXPECT_THAT(s.layer, ElementsAre(Layer::top, Layer::unknown));
    EXPECT_EQ(s.z_error[0], 0.4);
    EXPECT_TRUE(std::isnan(s.z_error[1]));
    EXPECT_EQ(s.quality[0], 0.03);
    EXPECT_TRUE(std::isnan(s.quality[1]));
    const Snapshot bare = points->read(1);
    EXPECT_TRUE(bare.id.empty() && bare.z.empty() && bare.position_error.empty() &&
                bare.z_error.empty() && bare.quality.empty() && bare.layer.empty());
}

TEST(PointsCsv, TakesTimesFromTheFrameRateAndTheBoxFromItsUser) {
    const testing::ScratchFolder folder;
    write_bytes(folder / "p.csv", "frame,x,y\n30,1,2\n30,4,6\n");
    const Box box{{0, 0}, {10, 10}, {Boundary::periodic, Boundary::periodic}, 0};
    EXPECT_EQ(open_points(folder / "p.csv", box, with_frame_rate(60))->read(0).time, 0.5);
    EXPECT_EQ(open_points(folder / "p.csv", box, {})->read(0).box, box);
    const Box found = open_points(folder / "p.csv", std::nullopt, {})->read(0).box;
    EXPECT_EQ(found, (Box{{1, 2}, {3, 4}}));
    EXPECT_THROW(open_points(folder / "p.csv", Box{{0, 0}, {0, 1}}, {}), OptionError);
}

TEST(PointsCsv, OnOneLineStillHasACellWithAnArea) {
    const testing::ScratchFolder folder;
    const auto points = open_text(folder / "p.csv", "frame,x,y\n0,1,2\n", with_diameter(9));
    EXPECT_EQ(points->read(0).box.length, (Vec2{9, 9}));
}

TEST(PointsCsv, WithAHeaderOnlyHasNoFrames) {
    const testing::ScratchFolder folder;
    const auto points = open_text(folder / "p.csv", "frame,x,y\n");
    EXPECT_EQ(points->count(), 0);
    EXPECT_THROW(points->read(0), OptionError);
}

TEST(PointsCsv, NamesTheLineOfABadNumber) {
    expect_refused("frame,x,y\n0,1,2\n0,1.2.3,4\n", "line 3: x is '1.2.3'");
    expect_refused("frame,x,y\r\n\r\n0,1,\r\n", "line 3: y is ''");
    expect_refused("frame,x,y\n0,nan,2\n", "line 2: x is 'nan'");
    expect_refused("frame,x,y\n0,inf,2\n", "line 2: x is 'inf'");
    expect_refused("frame,x,y\n0,1e999,2\n", "line 2: x is '1e999'");
    expect_refused("frame,x,y\n-1,1,2\n", "line 2: frame is '-1'");
    expect_refused("frame,x,y\n0.5,1,2\n", "line 2: frame is '0.5'");
    expect_refused("frame,x,y\n99999999999999999999,1,2\n", "line 2: frame is");
    expect_refused("frame,particle,x,y\n0,-3,1,2\n", "particle is '-3'");
    expect_refused("frame,x,y,z\n0,1,2,high\n", "z is 'high'");
    expect_refused("frame,x,y\n0,1\n", "2 fields");
    expect_refused("frame,x,y\n0,1,2\n1,\"2,3\n", "line 3");
}

TEST(PointsCsv, SaysWhatTheTableLacks) {
    expect_refused("", "empty");
    expect_refused("# only a remark\n", "empty");
    expect_refused("frame,x\n0,1\n", "no column 'y'");
    expect_refused("frame;x;y\n0;1;2\n", "no column 'frame'");
    expect_refused("frame,x,y,x\n0,1,2,3\n", "'x' occurs twice");
    expect_refused("frame,particle,x,y\n0,1,1,2\n0,,3,4\n", "1 of 2 points without");
    expect_refused("frame,x,y\n0,1," + std::string(100'000, '1'), "line 2: a line of more than");
    const testing::ScratchFolder folder;
    EXPECT_THROW(open_points(folder.path(), std::nullopt, {}), InputError);
    EXPECT_THROW(open_points(folder / "none.csv", std::nullopt, {}), InputError);
}

TEST(PointsCsv, ThatChangesWhileItIsReadIsRefused) {
    const testing::ScratchFolder folder;
    const std::string path = folder / "p.csv";
    const auto points = open_text(path, "frame,x,y\n0,1,2\n1,3,4\n2,5,6\n");
    write_bytes(path, "frame,x,y\n0,1,2\n1,3,4\n");
    EXPECT_THAT([&] { points->read(2); }, ThrowsMessage<InputError>(HasSubstr("shorter")));
    EXPECT_EQ(points->read(1).position.at(0), (Vec2{3, 4}));
    write_bytes(path, "frame,x,y\n0,1,2\n8,3,4\n");
    EXPECT_THAT([&] { points->read(1); }, ThrowsMessage<InputError>(HasSubstr("changed")));
}

// By frame, by particle and shuffled: the same snapshots, whatever the order of reading.
TEST(PointsCsv, ReadsFramesInAnyOrderFromLinesInAnyOrder) {
    const testing::ScratchFolder folder;
    constexpr int frames = 7;
    constexpr int particles = 11;
    std::string by_frame = "frame,particle,x,y\n";
    std::string by_particle = by_frame;
    const auto line = [](int f, int p) {
        return std::to_string(f) + "," + std::to_string(p) + "," + std::to_string(100 * f + p) +
               ".5," + std::to_string(p) + "\n";
    };
    for (int i = 0; i < frames * particles; ++i) {
        by_frame += line(i / particles, i % particles);
        by_particle += line(i % frames, i / frames);
    }
    const auto a = open_text(folder / "a.csv", by_frame);
    const auto b = open_text(folder / "b.csv", by_particle);
    ASSERT_EQ(a->count(), frames);
    ASSERT_EQ(b->count(), frames);
    for (const int f : {3, 0, 6, 6, 1, 5}) {
        expect_same(a->read(f), b->read(f));
        EXPECT_EQ(a->read(f).position[4], (Vec2{100.0 * f + 4.5, 4}));
    }
}

}  // namespace
}  // namespace grainfield::io
