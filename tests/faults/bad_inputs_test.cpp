// Cases 1 and 11 of docs/reliability.md: files that are not what they should be.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/support/random.h"
#include "tests/faults/bad_input.h"
#include "tests/support/disc_sequence.h"

namespace grainfield {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using testing::BadInput;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::run_grainfield;

using Case01 = BadInput;
using Case11 = BadInput;

TEST_F(Case01, AMissingEmptyUnreadableInputOrAFolderIsRefusedWithItsPath) {
    for (const char* name : {"missing.tif", "missing.png", "missing.avi", "missing.h5"}) {
        expect_refused_by_all(folder_ / name);
    }
    for (const char* name : {"empty.tif", "empty.png", "empty.avi", "empty.h5", "empty.csv"}) {
        expect_refused_by_all(write(name, ""));
    }
    fs::create_directory(folder_ / "folder.tif");
    expect_refused_by_all(folder_ / "folder.tif");
}

// Nobody may not read it; the superuser may read all.
TEST_F(Case01, AnInputWithoutPermissionIsRefusedWithItsPath) {
    const std::string file = write("secret.csv", "frame,x,y\n0,1,2\n0,2,2\n");
    fs::permissions(file, fs::perms::none);
    fs::permissions(folder_.path(), fs::perms::all);
    fs::permissions(out_.path(), fs::perms::all);
    std::string as_nobody;
    if (geteuid() == 0) {
        as_nobody = "setpriv --reuid 65534 --regid 65534 --clear-groups ";
        if (testing::shell(as_nobody + "\"$GRAINFIELD\" --version").code != 0) {
            GTEST_SKIP() << "the superuser reads all, and nobody may not run the program";
        }
    }
    const Outcome outcome = testing::shell(
        fmt::format("{}\"$GRAINFIELD\" analyze '{}' -o '{}'", as_nobody, file, out_ / "r.h5"));
    EXPECT_EQ(outcome.code, 3) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr(file), HasSubstr("it may not be read")));
    EXPECT_EQ(out_.entries(), 0U);
}

TEST_F(BadInput, TextUnderAnImageVideoOrDataNameIsRefused) {
    for (const char* name : {"text.tif", "text.png", "text.avi", "text.h5"}) {
        expect_refused_by_all(write(name, "This is not what its name says.\n"));
    }
}

TEST_F(Case11, RandomBytesBehindAGoodSignatureAreRefused) {
    std::string noise;
    RandomStream random(1, "bad bytes");
    for (int i = 0; i < 4096; ++i) noise.push_back(static_cast<char>(random.below(256)));
    expect_refused_by_all(write("noise.png", "\x89PNG\r\n\x1a\n" + noise));
    expect_refused_by_all(write("noise.tif", std::string("II*\0", 4) + noise));
    expect_refused_by_all(write("noise.h5", "\x89HDF\r\n\x1a\n" + noise));
    expect_refused_by_all(write("noise.cine", std::string("CI\x2c\0", 4) + noise));
}

/// Four bytes at `at`, little-endian.
std::string patched(std::string content, std::size_t at, std::uint32_t value) {
    for (unsigned i = 0; i < 4; ++i) {
        content.at(at + i) = static_cast<char>((value >> (8 * i)) & 0xffU);
    }
    return content;
}

// An entry of the directory has twelve bytes: tag, type, count, value.
TEST_F(Case11, OffsetsBeyondTheEndAndHugeSizesAreRefused) {
    testing::write_tiff(folder_ / "good.tif", testing::disc_frame(testing::few_discs(), 0));
    ASSERT_EQ(run_grainfield({"track", folder_ / "good.tif", "-o", folder_ / "t.h5"}).code, 0);
    const std::string good = testing::read_all(folder_ / "good.tif");
    const auto value_of = [](std::size_t entry) { return 10 + 12 * entry + 8; };
    std::vector<std::string> files{write("huge.pgm", "P5\n100000 100000\n255\nxx"),
                                   write("short.pgm", "P5\n100 100\n255\nxx")};
    for (const std::uint32_t beyond : {0xfffffff0U, 100000000U}) {
        files.push_back(write(fmt::format("directory{}.tif", beyond), patched(good, 4, beyond)));
        for (const std::size_t entry : {0U, 1U, 5U}) {  // width, height, strip
            files.push_back(write(fmt::format("entry{}-{}.tif", entry, beyond),
                                  patched(good, value_of(entry), beyond)));
        }
    }
    for (const std::string& file : files) {
        const Outcome outcome = run_grainfield({"track", file, "-o", out_ / "t.h5"});
        EXPECT_EQ(outcome.code, 3) << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr(file));
    }
    EXPECT_EQ(out_.entries(), 0U);
}

TEST_F(BadInput, PointsThatAreNotNumbersAreRefusedWithTheirLine) {
    const std::string points = write("points.csv", "frame,particle,x,y\n0,0,1,2\n0,1,three,4\n");
    const Outcome outcome =
        run_grainfield({"analyze", points, "-o", out_ / "r.h5", "--box", "10,10"});
    EXPECT_EQ(outcome.code, 3) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(points));
    EXPECT_THAT(outcome.err, HasSubstr("3"));
    EXPECT_EQ(out_.entries(), 0U);
}

}  // namespace
}  // namespace grainfield
