#include "io/input_record.h"

#include <atomic>
#include <csignal>
#include <fstream>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::io {
namespace {

TEST(InputRecord, HoldsSizeAndTheStandardCheckValue) {
    const testing::ScratchFolder folder;
    std::ofstream(folder / "x.bin") << "123456789";
    const RunRecord::Input record = describe_input(folder / "x.bin");
    EXPECT_EQ(record.name, folder / "x.bin");
    EXPECT_EQ(record.bytes, 9U);
    EXPECT_EQ(record.checksum, "crc32:cbf43926");  // the check value of this CRC's definition
}

TEST(InputRecord, IsTheSameWhereverPiecesEnd) {
    const testing::ScratchFolder folder;
    std::ofstream(folder / "zeros") << std::string((1U << 20U) + 1, '\0');
    EXPECT_EQ(describe_input(folder / "zeros").bytes, (1U << 20U) + 1);
    EXPECT_EQ(describe_input(folder / "zeros").checksum, "crc32:c6a48b28");
    std::ofstream(folder / "empty");
    EXPECT_EQ(describe_input(folder / "empty").checksum, "crc32:00000000");
}

TEST(InputRecord, NamesWhatCannotBeRead) {
    const testing::ScratchFolder folder;
    EXPECT_THROW(describe_input(folder / "absent"), InputError);
    EXPECT_THROW(describe_input(folder.path()), InputError);
}

TEST(InputRecord, OfAnInterruptedRunDoesNotTouchTheFile) {
    const testing::ScratchFolder folder;
    std::ofstream(folder / "x.bin") << "123456789";
    const std::atomic<int> stop{SIGTERM};
    const StoppableJob job(stop);
    // What cannot be opened shows that it was not tried: thousands of pictures would take seconds.
    EXPECT_EQ(describe_input(folder / "absent").checksum, "not computed, the run was interrupted");
    const RunRecord::Input record = describe_input(folder / "x.bin");
    EXPECT_EQ(record.checksum, "not computed, the run was interrupted");
    EXPECT_EQ(record.bytes, 9U);
}

}  // namespace
}  // namespace grainfield::io
