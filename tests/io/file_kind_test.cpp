#include "io/file_kind.h"

#include <gtest/gtest.h>

#include "core/errors.h"
#include "io/h5/results_file.h"
#include "io/h5/trajectory_file.h"
#include "tests/io/file_samples.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::io {
namespace {

TEST(FileKind, IsToldFromTheContentNotFromTheName) {
    const testing::ScratchFolder folder;
    TrajectoryWriter(folder / "a.csv", sample_info(), Overwrite::refuse).finish({});
    EXPECT_EQ(identify(folder / "a.csv"), FileKind::trajectory);
    Results results;
    results.box = {{0, 0}, {1, 1}};
    write_results(folder / "b.txt", results, Overwrite::refuse);
    EXPECT_EQ(identify(folder / "b.txt"), FileKind::results);
    write_bytes(folder / "c.h5", "# by some tracker\r\n\xEF\xBB\xBF\"Frame\", X ,Y\r\n");
    EXPECT_EQ(identify(folder / "c.h5"), FileKind::points);
    write_bytes(folder / "d.csv", "frame,x_px,y_px\n");
    EXPECT_EQ(identify(folder / "d.csv"), FileKind::points);
}

TEST(FileKind, OfAnythingElseIsUnknown) {
    const testing::ScratchFolder folder;
    EXPECT_EQ(identify(folder.path()), FileKind::unknown);
    for (const std::string bytes : {"", "x", "frame,x\n", "title: x, y\n", "II*", "\n\n\n", "#"}) {
        write_bytes(folder / "f", bytes);
        EXPECT_EQ(identify(folder / "f"), FileKind::unknown) << bytes;
    }
    write_bytes(folder / "f", std::string("frame,x,y\n\0", 11));
    EXPECT_EQ(identify(folder / "f"), FileKind::unknown);
}

TEST(FileKind, OfWhatIsMissingOrADamagedHdf5FileIsAnInputError) {
    const testing::ScratchFolder folder;
    EXPECT_THROW(identify(folder / "none"), InputError);
    write_bytes(folder / "f.h5", "\x89HDF\r\n\x1a\n and then something else");
    EXPECT_THROW(identify(folder / "f.h5"), InputError);
}

}  // namespace
}  // namespace grainfield::io
