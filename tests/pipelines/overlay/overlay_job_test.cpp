#include "pipelines/overlay/overlay_job.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "io/frame_files.h"
#include "io/h5/trajectory_file.h"
#include "io/input_record.h"
#include "tests/support/disc_sequence.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::pipelines {
namespace {

/// The particles of the small film, with a statement that they come from one.
std::string write_points(const testing::ScratchFolder& folder, int frames) {
    std::string path = folder / "points.csv";
    std::ofstream table(path);
    table << "frame,particle,x,y\n";
    for (int f = 0; f < frames; ++f) {
        int id = 0;
        for (const Vec2 p : testing::few_discs().position) {
            table << f << ',' << id++ << ',' << p.x + 0.3 * f << ',' << p.y - 0.2 * f << '\n';
        }
    }
    return path;
}

OverlayJobOptions to(const std::string& output) {
    OverlayJobOptions options;
    options.output = output;
    return options;
}

TEST(OverlayJob, WithoutAFilmDrawsEverySnapshotOnWhite) {
    const testing::ScratchFolder folder;
    Job job;
    job.inputs = {write_points(folder, 3)};
    OverlayJobOptions options = to(folder / "o.mkv");
    options.fps = 10;
    const OverlayJobResult result = draw_overlay(options, job);
    EXPECT_EQ(result.frames, 3);
    EXPECT_FALSE(result.has_film);
    EXPECT_GE(std::max(result.width, result.height), 1080);
    const auto video = io::open_frames({folder / "o.mkv"}, {});
    EXPECT_EQ(video->count(), 3);
    EXPECT_EQ(video->width(), result.width);
    EXPECT_EQ(video->frame_rate(), 10.0);
}

TEST(OverlayJob, DrawsOverTheFilmThatItIsGiven) {
    const testing::ScratchFolder folder;
    const testing::ScratchFolder film;
    testing::write_disc_sequence(film, 3);
    Job job;
    job.inputs = {write_points(folder, 3)};
    OverlayJobOptions options = to(folder / "o.mkv");
    options.film = film.path();
    const OverlayJobResult result = draw_overlay(options, job);
    EXPECT_TRUE(result.has_film);
    EXPECT_EQ(result.width, testing::kPictureSize);
    EXPECT_GT(result.height, testing::kPictureSize) << "caption and colour key stand below";
    // Spheres stay darker than what lies between them, contrast 170 of 255; on white they would
    // not.
    const Image drawn = io::open_frames({folder / "o.mkv"}, {})->read(0).image;
    const Image filmed = testing::disc_frame(testing::few_discs(), 0);
    double bright = 0, dark = 0, brights = 0, darks = 0;
    for (int y = 0; y < filmed.height(); ++y) {
        for (int x = 0; x < filmed.width(); ++x) {
            const bool is_clear = filmed(x, y) > 180;
            (is_clear ? bright : dark) += static_cast<double>(drawn(x, y));
            (is_clear ? brights : darks) += 1;
        }
    }
    EXPECT_GT(bright / brights, dark / darks + 170.0 / 3);
}

TEST(OverlayJob, RefusesToDrawPositionsInDiametersOnAFilm) {
    const testing::ScratchFolder folder;
    const testing::ScratchFolder film;
    testing::write_disc_sequence(film, 3);
    TrajectoryInfo info;
    info.length_unit = LengthUnit::diameter;
    io::TrajectoryWriter writer(folder / "md.h5", info, Overwrite::refuse);
    Snapshot snapshot;
    snapshot.position = {{1, 2}};
    snapshot.box.length = {4, 4};
    writer.write(snapshot);
    writer.finish({});
    Job job;
    job.inputs = {folder / "md.h5"};
    OverlayJobOptions options = to(folder / "o.mkv");
    options.film = film.path();
    EXPECT_THROW(draw_overlay(options, job), InputError);
}

TEST(OverlayJob, FindsARecordedFilmFromAnyFolder) {
    namespace fs = std::filesystem;
    const testing::ScratchFolder lab;
    fs::create_directories(lab.path() / "films");
    fs::create_directories(lab.path() / "results/today");
    std::ofstream(lab.path() / "films/cell.avi") << "twelve bytes";
    const fs::path tracks = lab.path() / "results/today/t.h5";
    // As "track films/cell.avi -o results/today/t.h5" was called in the folder above both.
    const RunRecord::Input input{.name = "films/cell.avi", .bytes = 12, .checksum = ""};
    EXPECT_EQ(find_recorded(input, tracks), lab.path() / "films/cell.avi");
    EXPECT_EQ(find_recorded({"films/cell.avi", 13, ""}, tracks), fs::path()) << "another film";
    EXPECT_EQ(find_recorded({"films/other.avi", 12, ""}, tracks), fs::path());
    const fs::path whole = lab.path() / "films/cell.avi";
    EXPECT_EQ(find_recorded({whole.string(), 12, ""}, tracks), whole);
    // Both were carried to another disk, side by side.
    fs::copy_file(whole, lab.path() / "results/today/cell.avi");
    EXPECT_EQ(find_recorded({"/gone/cell.avi", 12, ""}, tracks),
              lab.path() / "results/today/cell.avi");
}

TEST(OverlayJob, PassesByAnotherFilmOfTheSameNameAndSize) {
    namespace fs = std::filesystem;
    const testing::ScratchFolder lab;
    fs::create_directories(lab.path() / "raw/results");
    std::ofstream(lab.path() / "raw/cell.mraw") << "twelve bytes";
    std::ofstream(lab.path() / "raw/results/cell.mraw") << "other twelve";
    const RunRecord::Input tracked = io::describe_input(lab.path() / "raw/cell.mraw");
    RunRecord::Input input{"cell.mraw", tracked.bytes, tracked.checksum};
    const fs::path tracks = lab.path() / "raw/results/t.h5";
    EXPECT_EQ(find_recorded(input, tracks), lab.path() / "raw/cell.mraw");
    fs::remove(lab.path() / "raw/cell.mraw");
    EXPECT_EQ(find_recorded(input, tracks), fs::path());
    // Of a run that was interrupted only the size is known.
    input.checksum = "not computed, the run was interrupted";
    EXPECT_EQ(find_recorded(input, tracks), lab.path() / "raw/results/cell.mraw");
}

TEST(OverlayJob, RefusesTheOutputBeforeItLooksForTheFilm) {
    const testing::ScratchFolder folder;
    std::ofstream(folder / "o.mkv") << "kept";
    Job job;
    job.inputs = {write_points(folder, 3)};
    OverlayJobOptions options = to(folder / "o.mkv");
    options.film = folder / "no_such_film.avi";
    options.colour = OverlayColour::phase;
    EXPECT_THROW(draw_overlay(options, job), OutputError);
    job.overwrite = Overwrite::force;
    EXPECT_THROW(draw_overlay(options, job), InputError);
    EXPECT_EQ(folder.entries(), 2U) << "and leaves no temporary";
}

TEST(OverlayJob, RefusesATrajectoryWithoutFrames) {
    const testing::ScratchFolder folder;
    std::ofstream(folder / "none.csv") << "frame,x,y\n";
    Job job;
    job.inputs = {folder / "none.csv"};
    EXPECT_THROW(draw_overlay(to(folder / "o.mkv"), job), InputError);
    EXPECT_EQ(folder.entries(), 1U);
}

}  // namespace
}  // namespace grainfield::pipelines
