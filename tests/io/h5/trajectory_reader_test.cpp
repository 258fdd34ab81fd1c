#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "io/h5/detail/h5_group.h"
#include "io/h5/trajectory_file.h"
#include "tests/io/file_samples.h"
#include "tests/io/h5/cut_column.h"
#include "tests/support/program.h"

namespace grainfield::io {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// What stands beside this test; the Python of the distribution has the packages that labs use.
testing::Outcome run_script(const std::string& name, const std::string& argument) {
    return testing::Process({"/usr/bin/env", "PYTHONDONTWRITEBYTECODE=1", "/usr/bin/python3",
                             GRAINFIELD_SOURCE_DIR "/tests/io/h5/" + name, argument})
        .wait();
}

#define RUN_SCRIPT_OR_SKIP(outcome, name, argument)                            \
    const testing::Outcome outcome = run_script(name, argument);               \
    if (outcome.code == 77 || outcome.code == 127) {                           \
        GTEST_SKIP() << "no Python with MDAnalysis and h5py: " << outcome.out; \
    }                                                                          \
    ASSERT_EQ(outcome.code, 0) << outcome.err

double number(const json& value) {
    return value.is_null() ? std::nan("") : value.get<double>();
}

/// `tolerance` is relative to a coordinate of 100: MDAnalysis keeps single precision.
void expect_padded(const json& rows, const Snapshot& snapshot, double tolerance) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (i >= snapshot.size()) {
            for (const json& value : rows[i]) EXPECT_TRUE(value.is_null());
            continue;
        }
        ASSERT_EQ(rows[i].size(), 3U);
        EXPECT_NEAR(number(rows[i][0]), snapshot.position[i].x, tolerance);
        EXPECT_NEAR(number(rows[i][1]), snapshot.position[i].y, tolerance);
        EXPECT_NEAR(number(rows[i][2]), snapshot.z[i], tolerance);
    }
}

TEST(TrajectoryReader, OfLabScriptsOpensOurFiles) {
    const testing::ScratchFolder folder;
    const std::array snapshots{full_snapshot(0, 40), full_snapshot(2, 0), full_snapshot(3, 60)};
    {
        TrajectoryWriter writer(folder / "t.h5", sample_info(), Overwrite::refuse);
        for (const Snapshot& snapshot : snapshots) writer.write(snapshot);
        writer.add_preview(sample_preview());
        writer.finish(sample_record());
    }
    RUN_SCRIPT_OR_SKIP(outcome, "read_h5md.py", folder / "t.h5");
    const json content = json::parse(outcome.out);
    EXPECT_EQ(content["version"], json::array({1, 1}));
    EXPECT_EQ(content["author"], "grainfield");
    EXPECT_EQ(content["top"], json::array({"h5md", "parameters", "particles"}));
    EXPECT_EQ(content["boundary"], json::array({"none", "periodic", "none"}));
    EXPECT_EQ(content["dimension"], 3);
    EXPECT_TRUE(content["attributes"].empty()) << "a unit on position keeps readers out";
    EXPECT_EQ(content["shared"], true);
    EXPECT_EQ(content["checksums"], true);

    constexpr double single = 100 * 6e-8;  // half a unit in the last of 24 bits, at 100
    ASSERT_EQ(content["frames"].size(), snapshots.size());
    for (std::size_t i = 0; i < snapshots.size(); ++i) {
        const json& frame = content["frames"][i];
        EXPECT_EQ(frame["step"], snapshots[i].frame);
        EXPECT_EQ(frame["time"], snapshots[i].time);
        ASSERT_EQ(frame["position"].size(), 60U);
        expect_padded(frame["position"], snapshots[i], 0);
        expect_padded(frame["mda"], snapshots[i], single);
        for (std::size_t p = 0; p < 60; ++p) {
            EXPECT_EQ(frame["id"][p], p < snapshots[i].size() ? snapshots[i].id[p] : -1);
        }
        const Box& box = snapshots[i].box;
        const std::array<double, 6> expected{box.length.x, box.length.y, box.height, 90, 90, 90};
        for (std::size_t k = 0; k < expected.size(); ++k) {
            EXPECT_NEAR(number(frame["box"][k]), expected[k], 2 * single);
        }
    }
}

/// What kill -9 leaves of a run of five frames.
void write_killed(const testing::ScratchFolder& folder, const std::string& path) {
    TrajectoryWriter writer(folder / "t.h5", sample_info(), Overwrite::refuse);
    for (int i = 0; i < 5; ++i) writer.write(full_snapshot(i, 50));
    std::filesystem::copy_file(folder / "t.h5.partial", path);
}

TEST(TrajectoryReader, SaysHowManyFramesOfAKilledRunItLeavesOut) {
    for (const auto& [column, kept] : {std::pair{"/particles/trajectory/id/value", 4},
                                       {"/particles/trajectory/position/time", 2},
                                       {"/particles/trajectory/position/value", 3},
                                       {"/parameters/grainfield/box_height", 0}}) {
        const testing::ScratchFolder folder;
        write_killed(folder, folder / "left.h5");
        EXPECT_EQ(TrajectoryFile(folder / "left.h5").frames_left_out(), 0);
        EXPECT_TRUE(TrajectoryFile(folder / "left.h5").record().warnings.empty());
        cut_column(folder / "left.h5", column, static_cast<hsize_t>(kept));
        const TrajectoryFile file(folder / "left.h5");
        EXPECT_EQ(file.count(), kept) << column;
        EXPECT_EQ(file.frames_left_out(), 5 - kept) << column;
        ASSERT_EQ(file.record().warnings.size(), 1U) << column;
        EXPECT_EQ(file.record().warnings[0].code, WarningCode::incomplete);
        EXPECT_THAT(
            file.record().warnings[0].text,
            AllOf(HasSubstr("left.h5"), HasSubstr(std::to_string(5 - kept) + " of its 5 frames")));
    }
}

TEST(TrajectoryReader, OpensFilesOfMdAnalysis) {
    const testing::ScratchFolder folder;
    RUN_SCRIPT_OR_SKIP(outcome, "write_h5md.py", folder / "t.h5md");
    TrajectoryFile file(folder / "t.h5md");
    EXPECT_EQ(file.info().origin, Origin::points);
    EXPECT_EQ(file.info().source, "t.h5md");
    ASSERT_EQ(file.count(), 4);
    const Snapshot s = file.read(3);
    EXPECT_EQ(s.frame, 30);
    EXPECT_EQ(s.time, 0.75);
    EXPECT_THAT(s.position, ElementsAre(Vec2{1.5, 2.5}, Vec2{4.5, 5.5}, Vec2{7.5, 8.5}));
    EXPECT_THAT(s.z, ElementsAre(3.5, 6.5, 9.5));
    EXPECT_EQ(s.velocity.at(2), (Vec3{3, 3, 3}));
    EXPECT_EQ(s.box, (Box{{0, 0}, {8, 9}, {Boundary::periodic, Boundary::periodic}, 10}));
}

/// The parts of a small H5MD file of two frames, to be changed one at a time.
struct ForeignFile {
    std::vector<double> positions{1, 2, 3, 4, 5, 6, 7, 8};
    H5Extent extent{2, 2, 2};
    std::vector<std::int64_t> steps{0, 5};
    std::vector<double> times{0, 0.5};
    std::vector<double> edges{10, 20};
    H5Extent edges_extent{2};
    std::array<std::string, 2> boundary{"periodic", "none"};
    std::vector<std::int64_t> ids;
    bool has_h5md = true;
    bool has_box = true;

    void write(const std::string& path) const {
        H5File file = H5File::create(path, path);
        const H5Group root = H5Group::root(file);
        if (has_h5md) root.make_group("h5md");
        const H5Group atoms = root.make_group("particles").make_group("atoms");
        const H5Group position = atoms.make_group("position");
        position.write<double>("value", positions, extent);
        position.write<std::int64_t>("step", steps, {steps.size()});
        position.write<double>("time", times, {times.size()});
        if (!ids.empty()) {
            atoms.make_group("id").write<std::int64_t>("value", ids, {2, ids.size() / 2});
        }
        if (has_box) {
            const H5Group box = atoms.make_group("box");
            box.set_attribute("boundary", boundary);
            box.write<double>("edges", edges, edges_extent);
        }
        file.close();
    }
};

TEST(TrajectoryReader, OpensTwoDimensionalFilesWithAFixedBox) {
    const testing::ScratchFolder folder;
    ForeignFile foreign;
    foreign.ids = {4, 5, 6, -1};
    foreign.write(folder / "t.h5");
    TrajectoryFile file(folder / "t.h5");
    EXPECT_THAT(file.read(0).position, ElementsAre(Vec2{1, 2}, Vec2{3, 4}));
    EXPECT_TRUE(file.read(0).z.empty());
    const Snapshot second = file.read(1);
    EXPECT_EQ(second.frame, 5);
    EXPECT_EQ(second.time, 0.5);
    EXPECT_THAT(second.position, ElementsAre(Vec2{5, 6}));
    EXPECT_THAT(second.id, ElementsAre(6));
    EXPECT_EQ(second.box, (Box{{0, 0}, {10, 20}, {Boundary::periodic, Boundary::walls}, 0}));
}

/// What `scripts/make-fuzz-seeds` wrote with h5py: steps are 5 + 10 frames.
std::string h5py_file(const std::string& version) {
    return std::string(GRAINFIELD_SOURCE_DIR "/tests/faults/corpus/trajectories/other-") + version +
           ".h5";
}

TEST(TrajectoryReader, OpensTheOldestAndTheNewestFormatOfHdf5) {
    for (const char* version : {"earliest", "latest"}) {
        TrajectoryFile file(h5py_file(version));
        ASSERT_EQ(file.count(), 3) << version;
        EXPECT_EQ(file.read(2).frame, 25);
        EXPECT_THAT(file.read(2).id, ElementsAre(2, 0, 1));
    }
}

TEST(TrajectoryReader, RefusesStepsThatNoIntegerHolds) {
    const testing::ScratchFolder folder;
    const std::string path = folder / "t.h5";
    for (const double offset : {1e300, -1e19, 0.5, std::nan("")}) {
        std::filesystem::copy_file(h5py_file("earliest"), path,
                                   std::filesystem::copy_options::overwrite_existing);
        {
            const H5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT));
            const char* const step = "/particles/layer/position/step";
            ASSERT_GE(H5Adelete_by_name(file.get(), step, "offset", H5P_DEFAULT), 0);
            const H5Handle space(H5Screate(H5S_SCALAR));
            const H5Handle attribute(H5Acreate_by_name(file.get(), step, "offset",
                                                       H5T_NATIVE_DOUBLE, space.get(), H5P_DEFAULT,
                                                       H5P_DEFAULT, H5P_DEFAULT));
            ASSERT_GE(H5Awrite(attribute.get(), H5T_NATIVE_DOUBLE, &offset), 0);
        }
        EXPECT_THAT([&] { TrajectoryFile file(path); },
                    ThrowsMessage<InputError>(AllOf(HasSubstr("t.h5"), HasSubstr("below 2^53"))))
            << offset;
    }
}

TEST(TrajectoryReader, RefusesWhatMakesNoTrajectory) {
    const testing::ScratchFolder folder;
    const auto expect_refused = [&](const std::function<void(ForeignFile&)>& change,
                                    const char* part) {
        ForeignFile foreign;
        change(foreign);
        foreign.write(folder / "t.h5");
        const auto read_all = [&] {
            TrajectoryFile file(folder / "t.h5");
            for (std::int64_t i = 0; i < file.count(); ++i) file.read(i);
        };
        EXPECT_THAT(read_all, ThrowsMessage<InputError>(AllOf(HasSubstr("t.h5"), HasSubstr(part))));
    };
    using F = ForeignFile;
    expect_refused([](F& f) { f.has_h5md = false; }, "no trajectory");
    expect_refused([](F& f) { f.has_box = false; }, "no /particles/atoms/box");
    expect_refused([](F& f) { f.extent = {2, 4}; }, "the extent [2, 4]");
    expect_refused([](F& f) { f.extent = {2, 1, 4}; }, "the extent [2, 1, 4]");
    expect_refused([](F& f) { f.steps = {0}; }, "has 1 entries");
    expect_refused([](F& f) { f.steps = {3, 3}; }, "do not grow");
    expect_refused([](F& f) { f.steps = {-1, 3}; }, "do not grow");
    expect_refused([](F& f) { f.times[1] = std::nan(""); }, "no time");
    expect_refused(
        [](F& f) {
            f.times = {1, 1};
        },
        "/particles/atoms/position/time: frame 1 is at 1, the one before it at 1");
    expect_refused([](F& f) { f.times = {1, 0.5}; }, "frame 1 is at 0.5");
    const char* const third = "/particles/atoms/position/value, frame 5, particle number 0: ";
    expect_refused([](F& f) { f.positions[4] = 1e300; }, third);
    expect_refused([](F& f) { f.positions[5] = -INFINITY; }, third);
    expect_refused([](F& f) { f.positions[4] = 501; }, "beside a box of 10 × 20");
    expect_refused([](F& f) { f.positions[1] = NAN; }, "it is at (1, nan)");
    expect_refused([](F& f) { f.positions[0] = f.positions[1] = NAN; }, "has no position");
    expect_refused(
        [](F& f) {
            f.ids = {4, 5, 6, 6};
        },
        "frame 5, particle 6: it stands there twice");
    expect_refused(
        [](F& f) {
            f.ids = {4, 5, 6, 7};
            f.positions[6] = f.positions[7] = NAN;
        },
        "frame 5, particle 7: it has no position");
    expect_refused([](F& f) { f.boundary[0] = "sticky"; }, "unknown boundary 'sticky'");
    expect_refused([](F& f) { f.edges = {10, -1}; }, "box");
    expect_refused([](F& f) { f.edges = {10, std::nan("")}; }, "box");
    expect_refused(
        [](F& f) {
            f.edges = {10};
            f.edges_extent = {1};
        },
        "has 1 numbers");
    expect_refused(
        [](F& f) {
            f.edges = {10, 1, 0, 20};
            f.edges_extent = {2, 2};
        },
        "not rectangular");
    expect_refused([](F& f) { f.ids = {1, 2, 3, 4, 5, 6}; }, "in frame 0");
}

}  // namespace
}  // namespace grainfield::io
