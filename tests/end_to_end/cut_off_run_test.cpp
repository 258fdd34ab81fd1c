#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/h5/trajectory_file.h"
#include "tests/io/h5/cut_column.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using ::testing::HasSubstr;
using testing::Outcome;
using testing::run_grainfield;

TEST(CutOffRun, IsExportedAndDescribedWithTheNumberOfItsFramesThatAreLeftOut) {
    const testing::ScratchFolder folder;
    {
        io::TrajectoryWriter writer(folder / "t.h5", TrajectoryInfo{}, Overwrite::force);
        Snapshot snapshot;
        snapshot.box.length = {100, 100};
        snapshot.position = {{10, 10}, {30, 40}};
        for (snapshot.frame = 0; snapshot.frame < 4; ++snapshot.frame) {
            snapshot.time = static_cast<double>(snapshot.frame);
            writer.write(snapshot);
        }
        std::filesystem::copy_file(folder / "t.h5.partial", folder / "left.h5");
    }
    io::cut_column(folder / "left.h5", "/particles/trajectory/position/time", 1);
    for (const char* name : {"t.csv", "t.xyz"}) {
        const Outcome table = run_grainfield({"export", folder / "left.h5", "-o", folder / name});
        EXPECT_EQ(table.code, 0) << table.err;
        EXPECT_THAT(table.out, HasSubstr("1 frame"));
        EXPECT_THAT(table.err, HasSubstr("3 of its 4 frames are left out"));
    }
    const Outcome info = run_grainfield({"info", folder / "left.h5"});
    EXPECT_THAT(info.out, HasSubstr("3 of its 4 frames are left out"));
}

}  // namespace
}  // namespace grainfield
