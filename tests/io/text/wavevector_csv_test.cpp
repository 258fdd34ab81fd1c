#include "io/text/wavevector_csv.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield::io {
namespace {

using testing::HasSubstr;

class WavevectorCsv : public testing::Test {
 protected:
    std::filesystem::path write(const std::string& text) const {
        std::ofstream(path_, std::ios::binary) << text;
        return path_;
    }
    std::string failure(const std::string& text) const {
        try {
            read_wavevectors(write(text));
        } catch (const InputError& error) {
            return error.what();
        }
        return "no failure";
    }
    void TearDown() override { std::filesystem::remove(path_); }

    std::filesystem::path path_ =
        std::filesystem::temp_directory_path() /
        (std::string("wavevectors_") +
         testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv");
};

TEST_F(WavevectorCsv, ReadsNumbersWithAndWithoutHeaderCommentsAndBlanks) {
    for (const std::string header : {"", "kx,ky\n", "\xEF\xBB\xBF# of a lattice\n kx , ky \r\n"}) {
        const auto k = read_wavevectors(write(header + "0.5,-1e-3\n\n# more\n  2 ,\t0\r\n0,0.25"));
        ASSERT_EQ(k.size(), 3U);
        EXPECT_EQ(k[0].x, 0.5);
        EXPECT_EQ(k[0].y, -1e-3);
        EXPECT_EQ(k[1].x, 2);
        EXPECT_EQ(k[2].y, 0.25);
    }
}

TEST_F(WavevectorCsv, NamesFileLineAndFieldOfWhatItCannotRead) {
    EXPECT_THAT(failure("kx,ky\n1,2\n1,zwei\n"), HasSubstr("line 3"));
    EXPECT_THAT(failure("kx,ky\n1,2\n1,zwei\n"), HasSubstr("ky is 'zwei'"));
    EXPECT_THAT(failure("1,nan\n"), HasSubstr("ky is 'nan'"));
    EXPECT_THAT(failure("1;2\n"), HasSubstr("expected kx,ky in 1/a"));
    EXPECT_THAT(failure("1,2,3\n"), HasSubstr("line 1"));
    EXPECT_THAT(failure("1,2\n0,0\n"), HasSubstr("number of particles"));
    EXPECT_THAT(failure("1,2\nkx,ky\n"), HasSubstr("kx is 'kx'"));
    EXPECT_THAT(failure("# nothing\nkx,ky\n"), HasSubstr("lists no wavevectors"));
    EXPECT_THAT(failure("1,2\n"), HasSubstr("no failure"));
    EXPECT_THROW(read_wavevectors(path_.string() + ".missing"), InputError);
}

}  // namespace
}  // namespace grainfield::io
