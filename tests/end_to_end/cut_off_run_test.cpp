#include "tests/io/h5/cut_off_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/program.h"

namespace grainfield {
namespace {

using ::testing::HasSubstr;
using testing::Outcome;
using testing::run_grainfield;

TEST(CutOffRun, IsExportedAndDescribedWithTheNumberOfItsFramesThatAreLeftOut) {
    const testing::ScratchFolder folder;
    const std::string left = io::write_cut_off_run(folder);
    for (const char* name : {"t.csv", "t.xyz"}) {
        const Outcome table = run_grainfield({"export", left, "-o", folder / name});
        EXPECT_EQ(table.code, 0) << table.err;
        EXPECT_THAT(table.out, HasSubstr("1 frame"));
        EXPECT_THAT(table.err, HasSubstr("3 of its 4 frames are left out"));
    }
    const Outcome info = run_grainfield({"info", left});
    EXPECT_THAT(info.out, HasSubstr("3 of its 4 frames are left out"));
}

}  // namespace
}  // namespace grainfield
