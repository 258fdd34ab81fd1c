#include "io/h5/trajectory_file.h"

#include <atomic>
#include <csignal>
#include <filesystem>
#include <limits>
#include <optional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "tests/io/file_samples.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::io {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

void write_trajectory(const std::filesystem::path& path, const std::vector<Snapshot>& snapshots,
                      const std::vector<Preview>& previews = {}) {
    TrajectoryWriter writer(path, sample_info(), Overwrite::force);
    for (const Snapshot& snapshot : snapshots) writer.write(snapshot);
    for (const Preview& preview : previews) writer.add_preview(preview);
    writer.finish(sample_record());
}

void expect_round_trip(const std::vector<Snapshot>& snapshots) {
    const testing::ScratchFolder folder;
    write_trajectory(folder / "t.h5", snapshots);
    TrajectoryFile file(folder / "t.h5");
    ASSERT_EQ(file.count(), static_cast<std::int64_t>(snapshots.size()));
    for (std::size_t i = snapshots.size(); i-- > 0;) {
        expect_same(file.read(static_cast<std::int64_t>(i)), snapshots[i]);
    }
}

TEST(TrajectoryFile, GivesBackEveryBitOfEveryColumn) {
    expect_round_trip({full_snapshot(0, 700), full_snapshot(1, 700), full_snapshot(2, 700)});
}

TEST(TrajectoryFile, KeepsVaryingNumbersAnEmptyFrameAndGapsInTheIndex) {
    expect_round_trip({full_snapshot(0, 300), full_snapshot(2, 0), full_snapshot(3, 299),
                       full_snapshot(10, 1500), full_snapshot(11, 2)});
    expect_round_trip({full_snapshot(5, 0), full_snapshot(6, 40)});
    expect_round_trip({});
}

TEST(TrajectoryFile, KeepsWhichFramesHaveAColumn) {
    Snapshot unlinked = plain_snapshot(1, 12);
    unlinked.id.clear();
    Snapshot missing = plain_snapshot(4, 9);
    missing.quality.assign(9, std::numeric_limits<double>::quiet_NaN());
    missing.layer.assign(9, Layer::unknown);
    expect_round_trip(
        {plain_snapshot(0, 10), unlinked, full_snapshot(2, 8), plain_snapshot(3, 11), missing});
}

TEST(TrajectoryFile, KeepsInfoRecordAndPreviews) {
    const testing::ScratchFolder folder;
    write_trajectory(folder / "t.h5", {full_snapshot(0, 3)}, {sample_preview(), sample_preview()});
    const TrajectoryFile file(folder / "t.h5");
    expect_same(file.info(), sample_info());
    expect_same(file.record(), sample_record());
    ASSERT_EQ(file.previews().size(), 2U);
    expect_same(file.previews()[1], sample_preview());
}

TEST(TrajectoryFile, PreviewsOfAnInterruptedRunAreNotPacked) {
    const testing::ScratchFolder folder;
    Preview preview = sample_preview();
    preview.frame.image = Image(600, 500);
    write_trajectory(folder / "whole.h5", {full_snapshot(0, 3)}, {preview});
    EXPECT_LT(std::filesystem::file_size(folder / "whole.h5"), preview.frame.image.size());
    const std::atomic<int> stop{SIGTERM};
    const StoppableJob job(stop);
    write_trajectory(folder / "cut.h5", {full_snapshot(0, 3)}, {preview});
    EXPECT_GT(std::filesystem::file_size(folder / "cut.h5"), preview.frame.image.size());
    expect_same(TrajectoryFile(folder / "cut.h5").previews().at(0), preview);
}

TEST(TrajectoryFile, PreviewsOfDeepImagesAreOffByLessThanHalfALevel) {
    const testing::ScratchFolder folder;
    Preview preview = sample_preview();
    preview.frame.bit_depth = 16;
    for (float& p : preview.frame.image.pixels()) p = 1000 + 200 * p;
    write_trajectory(folder / "t.h5", {full_snapshot(0, 3)}, {preview});
    const Image read = TrajectoryFile(folder / "t.h5").previews().at(0).frame.image;
    const auto [low, high] = std::ranges::minmax(preview.frame.image.pixels());
    for (std::size_t i = 0; i < read.size(); ++i) {
        // Half a level, and the rounding of a float of this size (2^-24 relative).
        EXPECT_NEAR(read.pixels()[i], preview.frame.image.pixels()[i],
                    (high - low) / 510 + high * 1e-7F);
    }
}

TEST(TrajectoryFile, RefusesFramesOutOfOrderAndSnapshotsThatAreInconsistent) {
    const testing::ScratchFolder folder;
    TrajectoryWriter writer(folder / "t.h5", sample_info(), Overwrite::refuse);
    writer.write(full_snapshot(3, 5));
    EXPECT_THROW(writer.write(full_snapshot(3, 5)), OutputError);
    Snapshot broken = full_snapshot(4, 5);
    broken.z.pop_back();
    EXPECT_THROW(writer.write(broken), InputError);
    Snapshot other = full_snapshot(4, 5);
    other.box.boundary = {Boundary::periodic, Boundary::periodic};
    EXPECT_THROW(writer.write(other), OutputError);
}

TEST(TrajectoryFile, LeavesNothingBehindUnlessFinished) {
    const testing::ScratchFolder folder;
    {
        TrajectoryWriter writer(folder / "t.h5", sample_info(), Overwrite::refuse);
        writer.write(full_snapshot(0, 5));
        EXPECT_THROW(TrajectoryWriter(folder / "t.h5", sample_info(), Overwrite::force),
                     OutputError);
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(TrajectoryFile, OfAKilledRunStillHasItsFrames) {
    const testing::ScratchFolder folder;
    TrajectoryWriter writer(folder / "t.h5", sample_info(), Overwrite::refuse);
    for (int i = 0; i < 5; ++i) writer.write(full_snapshot(i, 50));
    // What is on disk at this moment is what kill -9 would leave.
    std::filesystem::copy_file(folder / "t.h5.partial", folder / "left.h5");
    TrajectoryFile left(folder / "left.h5");
    ASSERT_EQ(left.count(), 5);
    expect_same(left.read(4), full_snapshot(4, 50));
}

TEST(TrajectoryFile, CutAnywhereIsAnInputError) {
    const testing::ScratchFolder folder;
    write_trajectory(folder / "t.h5", {full_snapshot(0, 100), full_snapshot(1, 100)},
                     {sample_preview()});
    const std::string bytes = read_bytes(folder / "t.h5");
    for (std::size_t part = 0; part < 50; ++part) {
        write_bytes(folder / "cut.h5", bytes.substr(0, bytes.size() * part / 50));
        EXPECT_THROW(TrajectoryFile(folder / "cut.h5"), InputError) << part;
    }
}

TEST(TrajectoryFile, WithAFlippedBitInAPositionIsAnInputError) {
    const testing::ScratchFolder folder;
    const Snapshot snapshot = full_snapshot(0, 100);
    write_trajectory(folder / "t.h5", {snapshot});
    std::string bytes = read_bytes(folder / "t.h5");
    const std::string position(reinterpret_cast<const char*>(&snapshot.position[17]), sizeof(Vec2));
    const auto at = bytes.find(position);
    ASSERT_NE(at, std::string::npos);
    bytes[at] = static_cast<char>(bytes[at] ^ 4);
    write_bytes(folder / "t.h5", bytes);
    TrajectoryFile file(folder / "t.h5");
    EXPECT_THAT([&] { file.read(0); }, ThrowsMessage<InputError>(HasSubstr("damaged")));
}

// 400 files with one byte changed: each is read as some trajectory or refused, but never crashes.
TEST(TrajectoryFile, WithAnyByteChangedNeverCrashes) {
    const testing::ScratchFolder folder;
    write_trajectory(folder / "t.h5", {full_snapshot(0, 20), full_snapshot(1, 22)});
    const std::string bytes = read_bytes(folder / "t.h5");
    RandomStream random(11, "byte changes");
    for (int trial = 0; trial < 400; ++trial) {
        std::string changed = bytes;
        changed[random.below(changed.size())] = static_cast<char>(random.below(256));
        write_bytes(folder / "changed.h5", changed);
        try {
            TrajectoryFile file(folder / "changed.h5");
            for (std::int64_t i = 0; i < file.count(); ++i) file.read(i);
        } catch (const InputError&) {
        }
    }
}

TEST(TrajectoryFile, RefusesWhatIsNotATrajectory) {
    const testing::ScratchFolder folder;
    EXPECT_THROW(TrajectoryFile(folder / "none.h5"), InputError);
    EXPECT_THROW(TrajectoryFile(folder.path()), InputError);
    write_bytes(folder / "empty.h5", "");
    EXPECT_THROW(TrajectoryFile(folder / "empty.h5"), InputError);
    write_bytes(folder / "text.h5", "frame,x,y\n0,1,2\n");
    EXPECT_THAT([&] { TrajectoryFile(folder / "text.h5"); },
                ThrowsMessage<InputError>(HasSubstr("text.h5")));
}

TEST(TrajectoryFile, RefusesAFrameThatIsNotThere) {
    const testing::ScratchFolder folder;
    write_trajectory(folder / "t.h5", {full_snapshot(0, 3)});
    TrajectoryFile file(folder / "t.h5");
    EXPECT_THROW(file.read(1), OptionError);
    EXPECT_THROW(file.read(-1), OptionError);
}

// A limit on the size of files stands for a full disk: the system call fails in the same place.
[[noreturn]] void write_on_a_full_disk(const std::filesystem::path& path) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{200'000, 200'000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
        TrajectoryWriter writer(path, sample_info(), Overwrite::force);
        for (int i = 0; i < 100; ++i) writer.write(full_snapshot(i, 1000));
        writer.finish(sample_record());
    } catch (const OutputError& error) {
        std::fprintf(stderr, "%s\n", error.what());
        std::exit(4);
    }
    std::exit(0);
}

TEST(TrajectoryFileDeathTest, ReportsAFullDiskKeepsTheOldFileAndDoesNotCrashAtExit) {
    const testing::ScratchFolder folder;
    write_bytes(folder / "t.h5", "old");
    EXPECT_EXIT(write_on_a_full_disk(folder / "t.h5"), ::testing::ExitedWithCode(4),
                "cannot write .*t.h5.*File too large");
    EXPECT_EQ(read_bytes(folder / "t.h5"), "old");
    EXPECT_FALSE(std::filesystem::exists(folder / "t.h5.partial"));
}

}  // namespace
}  // namespace grainfield::io
