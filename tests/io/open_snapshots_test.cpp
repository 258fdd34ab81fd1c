#include "io/open_snapshots.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "io/h5/results_file.h"
#include "io/h5/trajectory_file.h"
#include "tests/io/file_samples.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::io {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(OpenSnapshots, TakesTrajectoriesAndTables) {
    const testing::ScratchFolder folder;
    {
        TrajectoryWriter writer(folder / "t.h5", sample_info(), Overwrite::refuse);
        writer.write(full_snapshot(4, 6));
        writer.finish({});
    }
    const auto trajectory = open_snapshots(folder / "t.h5", std::nullopt, {});
    EXPECT_EQ(trajectory->info().origin, Origin::video);
    expect_same(trajectory->read(0), full_snapshot(4, 6));
    write_bytes(folder / "p.txt", "frame,x,y\n4,1,2\n");
    const auto points = open_snapshots(folder / "p.txt", std::nullopt, with_diameter(3));
    EXPECT_EQ(points->info().diameter, 3);
    EXPECT_EQ(points->read(0).frame, 4);
}

TEST(OpenSnapshots, SaysWhatItWasGivenInstead) {
    const testing::ScratchFolder folder;
    Results results;
    results.box = {{0, 0}, {1, 1}};
    write_results(folder / "r.h5", results, Overwrite::refuse);
    EXPECT_THAT([&] { open_snapshots(folder / "r.h5", std::nullopt, {}); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("r.h5"), HasSubstr("results"))));
    write_bytes(folder / "a.png", "\x89PNG\r\n");
    EXPECT_THROW(open_snapshots(folder / "a.png", std::nullopt, {}), InputError);
    EXPECT_THROW(open_snapshots(folder / "none.h5", std::nullopt, {}), InputError);
    write_bytes(folder / "p.csv", "frame,x,why\n");
    EXPECT_THAT([&] { open_snapshots(folder / "p.csv", std::nullopt, {}); },
                ThrowsMessage<InputError>(HasSubstr("no column 'y'")));
}

}  // namespace
}  // namespace grainfield::io
