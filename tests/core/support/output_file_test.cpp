#include "core/support/output_file.h"

#include <cstdio>
#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/errors.h"
#include "tests/io/file_samples.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::io {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(WriteFile, IsWholeOrNothing) {
    const testing::ScratchFolder folder;
    const std::filesystem::path target = folder / "page.html";
    grainfield::write_file(target, "old", Overwrite::refuse);
    EXPECT_THROW(grainfield::write_file(target, "new", Overwrite::refuse), OutputError);
    EXPECT_EQ(read_bytes(target), "old");
    grainfield::write_file(target, "new", Overwrite::force);
    EXPECT_EQ(read_bytes(target), "new");
    EXPECT_EQ(folder.entries(), 1U);
    EXPECT_THAT([] { grainfield::write_file("/proc/x.html", "x", Overwrite::refuse); },
                ThrowsMessage<OutputError>(HasSubstr("files cannot be made in it")));
}

TEST(OutputFile, AppearsUnderItsNameOnlyWhenCommitted) {
    const testing::ScratchFolder folder;
    const std::filesystem::path target = folder / "x.txt";
    OutputFile file(target, Overwrite::refuse);
    write_bytes(file.temporary(), "content");
    EXPECT_FALSE(std::filesystem::exists(target));
    file.commit();
    EXPECT_EQ(read_bytes(target), "content");
    EXPECT_FALSE(std::filesystem::exists(file.temporary()));
}

TEST(OutputFile, LeavesTheOldContentAndNoTemporaryWithoutACommit) {
    const testing::ScratchFolder folder;
    const std::filesystem::path target = folder / "x.txt";
    write_bytes(target, "old");
    std::filesystem::path temporary;
    {
        const OutputFile file(target, Overwrite::force);
        temporary = file.temporary();
        write_bytes(temporary, "half of the n");
    }
    EXPECT_EQ(read_bytes(target), "old");
    EXPECT_FALSE(std::filesystem::exists(temporary));
}

TEST(OutputFile, RefusesAnExistingTargetUnlessForced) {
    const testing::ScratchFolder folder;
    const std::filesystem::path target = folder / "x.txt";
    write_bytes(target, "old");
    EXPECT_THAT([&] { OutputFile(target, Overwrite::refuse); },
                ThrowsMessage<OutputError>(HasSubstr("option 'force'")));
    OutputFile file(target, Overwrite::force);
    write_bytes(file.temporary(), "new");
    file.commit();
    EXPECT_EQ(read_bytes(target), "new");
}

TEST(OutputFile, RefusesATargetThatAppearedDuringTheRun) {
    const testing::ScratchFolder folder;
    const std::filesystem::path target = folder / "x.txt";
    OutputFile file(target, Overwrite::refuse);
    write_bytes(target, "of somebody else");
    EXPECT_THROW(file.commit(), OutputError);
    EXPECT_EQ(read_bytes(target), "of somebody else");
}

TEST(OutputFile, RefusesASecondWriterAndAdmitsItAfterTheFirst) {
    const testing::ScratchFolder folder;
    const std::filesystem::path target = folder / "x.txt";
    {
        const OutputFile first(target, Overwrite::force);
        EXPECT_THAT([&] { OutputFile(target, Overwrite::force); },
                    ThrowsMessage<OutputError>(HasSubstr("another run")));
        EXPECT_TRUE(std::filesystem::exists(first.temporary()));
    }
    EXPECT_NO_THROW(OutputFile(target, Overwrite::force));
}

TEST(OutputFile, ReplacesTheTemporaryOfAKilledRun) {
    const testing::ScratchFolder folder;
    const std::filesystem::path target = folder / "x.txt";
    write_bytes(folder / "x.txt.partial", "left behind");
    OutputFile file(target, Overwrite::refuse);
    EXPECT_EQ(read_bytes(file.temporary()), "");
    file.commit();
    EXPECT_EQ(read_bytes(target), "");
}

TEST(OutputFile, SaysHowToMendAMissingFolder) {
    const testing::ScratchFolder folder;
    EXPECT_THAT([&] { OutputFile(folder / "no/x.txt", Overwrite::refuse); },
                ThrowsMessage<OutputError>(HasSubstr("mkdir -p")));
}

TEST(OutputFile, RefusesAFolderAsTarget) {
    const testing::ScratchFolder folder;
    EXPECT_THROW(OutputFile(folder.path(), Overwrite::force), OutputError);
    EXPECT_THROW(OutputFile(folder / "", Overwrite::force), OutputError);
}

TEST(OutputFile, RefusesADeviceEvenIfForced) {
    const testing::ScratchFolder folder;
    const std::filesystem::path link = folder / "link";
    std::filesystem::create_symlink("/dev/null", link);
    EXPECT_THAT([&] { OutputFile(link, Overwrite::force); },
                ThrowsMessage<OutputError>(HasSubstr("device")));
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(OutputFile, DoesNotWriteThroughALinkInThePlaceOfItsTemporary) {
    const testing::ScratchFolder folder;
    write_bytes(folder / "victim", "of value");
    std::filesystem::create_symlink(folder / "victim", folder / "x.txt.partial");
    EXPECT_THAT([&] { OutputFile(folder / "x.txt", Overwrite::force); },
                ThrowsMessage<OutputError>(HasSubstr("symbolic link")));
    EXPECT_EQ(read_bytes(folder / "victim"), "of value");
}

// Root may write everywhere, so that it must become somebody else first.
[[noreturn]] void write_as_an_ordinary_user(const std::filesystem::path& target) {
    constexpr uid_t nobody = 65534;
    if (::geteuid() == 0 && ::setuid(nobody) != 0) std::exit(9);
    try {
        OutputFile(target, Overwrite::refuse);
    } catch (const OutputError& error) {
        std::fprintf(stderr, "%s\n", error.what());
        std::exit(4);
    }
    std::exit(0);
}

TEST(OutputFileDeathTest, RefusesAFolderThatMayNotBeWritten) {
    const testing::ScratchFolder folder;
    using std::filesystem::perms;
    constexpr perms read_only =
        perms::owner_read | perms::owner_exec | perms::others_read | perms::others_exec;
    std::filesystem::permissions(folder.path(), read_only);
    EXPECT_EXIT(write_as_an_ordinary_user(folder / "x.txt"), ::testing::ExitedWithCode(4),
                "cannot write .*x.txt.*Permission denied");
    std::filesystem::permissions(folder.path(), perms::owner_all);
}

}  // namespace
}  // namespace grainfield::io
